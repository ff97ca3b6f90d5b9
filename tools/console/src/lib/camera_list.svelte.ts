import { fetchDevices, type CameraDevice, type Devices } from './devices';

/** The cameras of the board, as they were found last. Looking again opens those that nobody uses, so a part of the page that appears takes what is known. */
class CameraList {
  cameras = $state.raw<CameraDevice[] | null>(null);
  error = $state('');
  looking = $state(false);

  async look(): Promise<void> {
    if (this.looking) return;
    this.looking = true;
    this.error = '';
    try {
      this.cameras = (await fetchDevices<Devices>('/devices')).cameras;
    } catch (reason) {
      this.error = reason instanceof Error ? reason.message : String(reason);
    }
    this.looking = false;
  }
}

export const cameraList = new CameraList();
