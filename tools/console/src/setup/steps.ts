import { SETUP_STEPS, type Level, type StepName } from '../lib/setup_protocol';

export const STEP_TITLES: Record<StepName, string> = { camera: 'Camera', field: 'Field', light: 'Light', colors: 'Colors', robots: 'Robots', radio: 'Radio' };

/** A state is never told by its color alone. */
export const LEVELS: Record<Level, { sign: string; word: string }> = {
  none: { sign: '–', word: 'not measured yet' },
  ok: { sign: '✓', word: 'good' },
  warning: { sign: '!', word: 'could be better' },
  bad: { sign: '✕', word: 'not good enough' },
};

export function stepAfter(name: StepName): StepName | null {
  return SETUP_STEPS[SETUP_STEPS.indexOf(name) + 1] ?? null;
}
