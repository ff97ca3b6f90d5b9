import type { Field } from './protocol';

type Line = [number, number][];

/** Field lines as points at most 5 cm apart, so that they stay on the lines of a picture with lens distortion. */
export function fieldLines(field: Field): Line[] {
  const x = field.length_m / 2;
  const y = field.width_m / 2;
  const goal = field.goal_width_m / 2;
  const back = x + field.goal_depth_m;
  const lines: Line[] = [
    dense([[-x, -y], [x, -y], [x, y], [-x, y], [-x, -y]]),
    dense([[0, -y], [0, y]]),
    dense([[x, -goal], [back, -goal], [back, goal], [x, goal]]),
    dense([[-x, -goal], [-back, -goal], [-back, goal], [-x, goal]]),
  ];
  if (field.center_circle_m) {
    const r = field.center_circle_m;
    lines.push(Array.from({ length: 49 }, (_, i): [number, number] => [r * Math.cos((i * Math.PI) / 24), r * Math.sin((i * Math.PI) / 24)]));
  }
  if (field.penalty_area_depth_m && field.penalty_area_width_m) {
    const depth = x - field.penalty_area_depth_m;
    const half = field.penalty_area_width_m / 2;
    lines.push(dense([[x, -half], [depth, -half], [depth, half], [x, half]]), dense([[-x, -half], [-depth, -half], [-depth, half], [-x, half]]));
  }
  return lines;
}

function dense(corners: Line): Line {
  const points: Line = [];
  corners.forEach(([x, y], i) => {
    const before = corners[i - 1];
    if (before) {
      const steps = Math.max(1, Math.ceil(Math.hypot(x - before[0], y - before[1]) / 0.05));
      for (let k = 1; k < steps; k += 1) points.push([before[0] + ((x - before[0]) * k) / steps, before[1] + ((y - before[1]) * k) / steps]);
    }
    points.push([x, y]);
  });
  return points;
}
