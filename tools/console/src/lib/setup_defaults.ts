import { SETUP_STEPS, type SetupState, type SetupSteps, type Step } from './setup_protocol';

const team = () => ({ layout: '', color: '', robots: [] });

function emptySteps(): SetupSteps {
  const step = (): Step => ({ done: false, quality: { level: 'none', text: '' }, notes: [] });
  return {
    camera: { ...step(), values: {} },
    field: { ...step(), values: {}, presets: [] },
    light: step(),
    colors: { ...step(), names: [], wanted: [], pictures: [], clicks: [] },
    robots: { ...step(), layouts: [], own: team(), opponent: team() },
    radio: { ...step(), values: {}, devices: [], format: 'touchline', formats: [], sample: '', remarks: '' },
  };
}

/** The members that are there and are not null, over those of `base`. */
function over<T extends object>(base: T, values: object | null | undefined): T {
  const present = Object.entries(values ?? {}).filter(([name, value]) => value !== null || !(name in base));
  return { ...base, ...Object.fromEntries(present) };
}

/** A state of an older setup program may lack members; the page need not ask for each of them. */
export function completeState(state: Partial<SetupState>): SetupState {
  const steps = emptySteps();
  const filled = Object.fromEntries(SETUP_STEPS.map((name) => [name, over(steps[name], state.steps?.[name])])) as unknown as SetupSteps;
  for (const name of SETUP_STEPS) filled[name].quality = over(steps[name].quality, filled[name].quality);
  filled.robots.own = over(team(), filled.robots.own);
  filled.robots.opponent = over(team(), filled.robots.opponent);
  return { open: false, busy: null, error: null, changed_files: [], undo: [], redo: [], ...state, steps: filled };
}
