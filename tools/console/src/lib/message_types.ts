// Types that the messages of the game and those of the setup share.

export type TeamName = 'own' | 'opponent';
export type Rgb = [number, number, number];
