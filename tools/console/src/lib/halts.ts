export interface HaltText {
  reason: string; // continues "Robots stopped: "
  remedy: string;
}

const HALT_TEXTS: Record<string, HaltText> = {
  console: { reason: 'Stop was pressed, or the page with control was closed', remedy: 'The driver can press Start.' },
  no_frames: { reason: 'no picture from the camera', remedy: 'Check the camera and its cable. Robots move again with the first good picture.' },
  repeats: {
    reason: 'the camera repeats its pictures, as a whole or in a part',
    remedy: 'Check the camera and its cable. Robots move again with new pictures. If a part of the picture was delayed, the driver must press Start.',
  },
  overload: { reason: 'too many colored regions in the picture', remedy: 'Look at the picture: other things have the colors of robots and ball. Remove them, or learn the colors again.' },
  field: { reason: 'the field is not recognizable', remedy: 'Check lamps and camera: the picture is dark, covered, or shows something else.' },
  motion: {
    reason: 'robots do not move as commanded',
    remedy: 'Check batteries, radio (another sender?) and picture (turned?). Then the driver or the start button must start the robots.',
  },
  emergency: { reason: 'the emergency stop is pulled, or was pulled', remedy: 'Release the switch at the board. This page cannot release it. Then the driver can press Start.' },
  unreadable_line: { reason: 'the emergency stop cannot be read', remedy: 'Check the wire of the emergency stop and the GPIO lines of the board file.' },
  start: { reason: 'the start button was not pressed yet', remedy: 'Press the start button at the board, or Start on this page.' },
  crash: { reason: 'the last run ended unexpectedly', remedy: 'Look at the event log. Then press Start on this page or at the board, or restart the service.' },
  referee: { reason: 'the referee stopped the game', remedy: 'Robots move again when the referee continues the game.' },
  teams: { reason: 'the referee asks for team colors or heights that the team file does not have', remedy: 'Correct the team file or the referee\'s settings.' },
  setup_ended: { reason: 'the setup has ended', remedy: 'The driver can press Start.' },
  setup: { reason: 'the board is being set up', remedy: 'Save or discard the setup on the page Set up.' },
  radio: { reason: 'the radio is disconnected, or was for too long', remedy: 'Check the radio and its cable. If robots stay stopped after it is connected again, the driver can press Start.' },
  driver: { reason: 'the page with control stopped answering', remedy: 'Check its connection. The driver can press Start.' },
  silence: { reason: 'no message from the referee', remedy: 'Check the network to the referee\'s computer.' },
};

// `setup` with the saved files: nobody has begun to set up, but the robots cannot be recognized.
const NOT_CALIBRATED: HaltText = { reason: 'the board is not set up yet', remedy: 'Start on the page Set up.' };

/** What a halt means and what to do; a word that this page does not know is shown as it is. `isBare`: the saved files are not calibrated. */
export function haltText(word: string, isBare = false): HaltText {
  if (isBare && word === 'setup') return NOT_CALIBRATED;
  return Object.hasOwn(HALT_TEXTS, word) ? HALT_TEXTS[word]! : { reason: word, remedy: '' };
}

/** `setup_ended` explains `console`: nobody has pressed Stop then. */
export function reasonsToShow(halt: readonly string[]): readonly string[] {
  return halt.includes('setup_ended') ? halt.filter((word) => word !== 'console') : halt;
}

/** "the emergency stop is pulled, no picture from the camera" */
export function haltReasons(halt: readonly string[], isBare = false): string {
  return reasonsToShow(halt).map((word) => haltText(word, isBare).reason).join(', ');
}
