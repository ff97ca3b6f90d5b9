import type { Setup } from '../lib/setup.svelte';

// Of an import's pieces; the program takes at most 3000 bytes of text in one, and a character has at most three.
const PIECE_CHARACTERS = 1000;
// The server disconnects a client that sends more than 100 messages a second.
const PIECE_INTERVAL_MS = 15;

/** Saves a text as a file of this device. */
export function download(name: string, text: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type: 'application/octet-stream' }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export async function exportSetup(setup: Setup): Promise<void> {
  const file = await setup.ask<{ name: string; text: string }>({ command: 'export' });
  if (file) download(file.name, file.text);
}

/** Pieces of at most `characters`, none of which ends within a pair of surrogates. */
export function pieces(text: string, characters: number): string[] {
  const result: string[] = [];
  for (let from = 0; from < text.length; ) {
    let to = Math.min(from + characters, text.length);
    const last = text.charCodeAt(to - 1);
    if (to < text.length && last >= 0xd800 && last < 0xdc00) to -= 1;
    result.push(text.slice(from, to));
    from = to;
  }
  return result.length ? result : [''];
}

/** Returns whether the file is the draft now. `progress`: 0 to 1. */
export async function importSetup(setup: Setup, file: File, progress: (share: number) => void): Promise<boolean> {
  const parts = pieces(await file.text(), PIECE_CHARACTERS);
  for (const [part, text] of parts.entries()) {
    if (!(await setup.ask({ command: 'import', part, parts: parts.length, text }))) return false;
    progress((part + 1) / parts.length);
    await new Promise((resolve) => setTimeout(resolve, PIECE_INTERVAL_MS));
  }
  return true;
}
