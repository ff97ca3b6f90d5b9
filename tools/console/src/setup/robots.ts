import type { RobotRef, RobotsStep } from '../lib/setup_protocol';

// Colors of robots that look alike, in levels of the channel that separates them best.
const ALIKE_LEVELS = 20;

export const nameOf = ({ team, id }: RobotRef) => `${team === 'own' ? 'own' : 'opponent'} ${id}`;

export const lookAlike = (robots: RobotsStep) => (robots.similar ?? []).filter(({ levels }) => levels < ALIKE_LEVELS);
