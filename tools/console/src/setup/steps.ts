import { SETUP_STEPS, type Level, type StepName } from '../lib/setup_protocol';

export const STEP_TITLES: Record<StepName, string> = { camera: 'Camera', field: 'Field', light: 'Light', colors: 'Colors', robots: 'Robots', radio: 'Radio' };

/** What a person does there, for the page before the first step. */
export const STEP_AIMS: Record<StepName, string> = {
  camera: 'aim, focus and expose it',
  field: 'find its lines in the picture',
  light: 'measure how it falls on the field',
  colors: 'find those of robots and ball',
  robots: 'say how their tops and the ball look',
  radio: 'drive one robot',
};

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
