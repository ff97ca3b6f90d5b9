import { fetchDevices, type CameraDevice, type Devices } from './devices';

/** The cameras of the board, as they were found last. Looking again opens those that nobody uses, so a part of the page that appears takes what is known. */
class CameraList {
  cameras = $state.raw<CameraDevice[] | null>(null);
  problems = $state.raw<string[]>([]);
  error = $state('');
  looking = $state(false);

  async look(): Promise<void> {
    if (this.looking) return;
    this.looking = true;
    this.error = '';
    try {
      const devices = await fetchDevices<Devices>('/devices');
      this.cameras = devices.cameras;
      this.problems = devices.problems ?? [];
    } catch (reason) {
      this.error = reason instanceof Error ? reason.message : String(reason);
    }
    this.looking = false;
  }
}

export const cameraList = new CameraList();
