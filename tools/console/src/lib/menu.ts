/** For a <details> that is a menu: it closes on Escape, which returns the focus to its summary, and when something else is pressed or has the focus. */
export function menu(details: HTMLDetailsElement): { destroy(): void } {
  const isInside = (event: Event) => event.target instanceof Node && details.contains(event.target);
  const onElsewhere = (event: Event) => {
    if (!isInside(event)) details.open = false;
  };
  const onKey = (event: KeyboardEvent) => {
    if (event.key !== 'Escape' || !details.open) return;
    details.open = false;
    details.querySelector('summary')?.focus();
    event.stopPropagation();
  };
  // A command of the menu was chosen.
  const onClick = (event: Event) => {
    if (event.target instanceof Element && event.target.closest('button')) details.open = false;
  };
  document.addEventListener('pointerdown', onElsewhere);
  document.addEventListener('focusin', onElsewhere);
  document.addEventListener('keydown', onKey);
  details.addEventListener('click', onClick);
  return {
    destroy() {
      document.removeEventListener('pointerdown', onElsewhere);
      document.removeEventListener('focusin', onElsewhere);
      document.removeEventListener('keydown', onKey);
      details.removeEventListener('click', onClick);
    },
  };
}
