// The devices of the rehearsal server: a camera that works, one that somebody else uses, one that is not readable; two adapters.
import { makePicture } from './picture.js';

const sizes = [
  { width_px: 640, height_px: 480, rates_hz: [60, 30] },
  { width_px: 1280, height_px: 720, rates_hz: [30] },
];
const name = '/dev/v4l/by-id/usb-Rehearsal_Camera-video-index0';

export const ports = {
  serial_ports: [
    { path: '/dev/ttyS0', name: '/dev/ttyS0', by_id: '', by_path: '', description: 'ttyS0', kind: 'native' },
    { path: '/dev/ttyUSB0', name: '/dev/serial/by-id/usb-Rehearsal_Radio-if00-port0', by_id: '/dev/serial/by-id/usb-Rehearsal_Radio-if00-port0', by_path: '', description: 'Rehearsal Radio', kind: 'usb' },
    { path: '/dev/ttyACM1', name: '/dev/ttyACM1', by_id: '', by_path: '', description: 'Adapter without a serial number', kind: 'usb', refused: '/dev/ttyACM1: permission denied; add the user to the group dialout (`sudo usermod -aG dialout $USER`) and log in again' },
  ],
  gpio_chips: [{ path: '/dev/gpiochip0', label: 'pinctrl-rp1', line_count: 54, lines: [] }],
};

export const devices = (game) => ({
  ...ports,
  cameras: [
    {
      path: '/dev/video0', name, by_id: name, by_path: '', card: 'Rehearsal Camera', driver: 'uvcvideo', bus: 'usb-0000:00:14.0-1', used: game.lost.length === 0,
      formats: [{ format: 'yuyv', fourcc: 'YUYV', description: 'YUYV 4:2:2', sizes }, { format: 'mjpg', fourcc: 'MJPG', description: 'Motion-JPEG', sizes }],
      suggested: { device: name, format: 'yuyv', width_px: 640, height_px: 480, rate_hz: 60 },
      ...(game.lost.length ? { thumbnail: `data:image/jpeg;base64,${makePicture(game).subarray(32).toString('base64')}` } : {}),
    },
    {
      path: '/dev/video2', name: '/dev/v4l/by-path/platform-usb-0:2:1.0-video-index0', by_id: '', by_path: '/dev/v4l/by-path/platform-usb-0:2:1.0-video-index0', card: 'Other Camera', used: false,
      formats: [{ format: 'mjpg', fourcc: 'MJPG', description: 'Motion-JPEG', sizes }],
      suggested: { device: '/dev/v4l/by-path/platform-usb-0:2:1.0-video-index0', format: 'mjpg', width_px: 640, height_px: 480, rate_hz: 60 },
      refused: '/dev/v4l/by-path/platform-usb-0:2:1.0-video-index0: in use by guvcview (process 1234)',
    },
    {
      backend: 'libcamera', path: '/base/axi/pcie@1000120000/rp1/i2c@80000/imx296@1a', name: '/base/axi/pcie@1000120000/rp1/i2c@80000/imx296@1a', card: 'imx296', used: false,
      formats: [{ format: 'nv12', sizes: [{ width_px: 32, height_px: 32, max_width_px: 1456, max_height_px: 1088, rates_hz: [] }] }],
      suggested: { backend: 'libcamera', device: '/base/axi/pcie@1000120000/rp1/i2c@80000/imx296@1a', format: 'nv12', width_px: 1280, height_px: 1024, rate_hz: 60 },
      thumbnail: `data:image/jpeg;base64,${makePicture(game).subarray(32).toString('base64')}`,
    },
    { path: '/dev/video4', name: '/dev/video4', card: '', used: false, refused: '/dev/video4: its driver does not answer; unplug the device, or restart the board' },
  ],
});
