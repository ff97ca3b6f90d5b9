type Choice = 'system' | 'light' | 'dark';
const KEY = 'touchline.theme';

class Theme {
  choice = $state<Choice>('system');
  private readonly systemDark = matchMedia('(prefers-color-scheme: dark)');
  private systemIsDark = $state(this.systemDark.matches);
  dark = $derived(this.choice === 'system' ? this.systemIsDark : this.choice === 'dark');

  constructor() {
    // Storage may be switched off; the choice then lasts until the page is closed.
    try {
      const stored = localStorage.getItem(KEY);
      if (stored === 'light' || stored === 'dark') this.choice = stored;
    } catch {
      this.choice = 'system';
    }
    this.systemDark.addEventListener('change', (event) => (this.systemIsDark = event.matches));
  }

  toggle(): void {
    this.choice = this.dark ? 'light' : 'dark';
    try {
      localStorage.setItem(KEY, this.choice);
    } catch {
      return;
    }
  }
}

export const theme = new Theme();
