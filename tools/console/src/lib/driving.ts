/** Wanted motion as shares of the chosen speed: forward and to the left, each -1 to 1. */
export interface Motion {
  forward: number;
  left: number;
}

export const STANDING: Motion = { forward: 0, left: 0 };

const KEYS: Record<string, Motion> = {
  KeyW: { forward: 1, left: 0 },
  ArrowUp: { forward: 1, left: 0 },
  KeyS: { forward: -1, left: 0 },
  ArrowDown: { forward: -1, left: 0 },
  KeyA: { forward: 0, left: 1 },
  ArrowLeft: { forward: 0, left: 1 },
  KeyD: { forward: 0, left: -1 },
  ArrowRight: { forward: 0, left: -1 },
};

/** Keys by their place on the keyboard, so that WASD is the same block on every layout. */
export function isDrivingKey(code: string): boolean {
  return Object.hasOwn(KEYS, code);
}

export function motionOfKeys(held: ReadonlySet<string>): Motion {
  let forward = 0;
  let left = 0;
  for (const code of held) {
    const motion = KEYS[code];
    if (motion) {
      forward += motion.forward;
      left += motion.left;
    }
  }
  return { forward: Math.max(-1, Math.min(1, forward)), left: Math.max(-1, Math.min(1, left)) };
}

/** A touch at (x, y) of a pad with its center at 0, edges at 1, y upwards. The middle is a dead zone. */
export function motionOfPad(x: number, y: number): Motion {
  const deadZone = 0.08;
  const curve = (value: number) => {
    const bounded = Math.max(-1, Math.min(1, value));
    return Math.abs(bounded) < deadZone ? 0 : bounded;
  };
  return { forward: curve(y), left: -curve(x) };
}
