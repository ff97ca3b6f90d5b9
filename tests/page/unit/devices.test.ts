// What the page says about the devices of a board, and what it writes for one that is chosen.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cameraKeys, cameraState, chipText, fetchDevices, isNumbered, pictureText, portNamed, rateText, sizeText, sortedPorts, withUsed, type CameraDevice } from '../../../tools/console/src/lib/devices';

const suggested = { device: '/dev/v4l/by-id/usb-A', format: 'yuyv', width_px: 640, height_px: 480, rate_hz: 60 };
const camera: CameraDevice = { path: '/dev/video0', name: '/dev/v4l/by-id/usb-A', by_id: '/dev/v4l/by-id/usb-A', by_path: '/dev/v4l/by-path/usb-1', used: false, suggested };

test('a camera can be chosen unless it delivers already, is refused, or has no format that can be read', () => {
  assert.deepEqual(cameraState(camera, null), { choosable: true, text: '', problem: false });
  assert.equal(cameraState({ ...camera, used: true }, null).choosable, false);
  // It is named, but the loop has no camera: the suggested mode may be what helps.
  const lost = cameraState({ ...camera, used: true }, 'camera.rate_hz = 240 is not offered');
  assert.equal(lost.choosable, true);
  assert.match(lost.text, /240 is not offered/);
  assert.deepEqual(cameraState({ ...camera, refused: 'in use by another process' }, null), { choosable: false, text: 'in use by another process', problem: true });
  const { suggested: _, ...unreadable } = camera;
  assert.equal(cameraState(unreadable, null).choosable, false);
});

test('all keys of a camera are written together, under its lasting name', () => {
  assert.deepEqual(cameraKeys(suggested), { backend: 'v4l2', device: '/dev/v4l/by-id/usb-A', format: 'yuyv', width_px: 640, height_px: 480, rate_hz: 60 });
});

test('a camera of libcamera is written with its backend', () => {
  assert.equal(cameraKeys({ ...suggested, backend: 'libcamera', device: '/base/soc/i2c/imx296@1a' }).backend, 'libcamera');
});

test('in the place of a picture stands who has the camera', () => {
  assert.equal(pictureText(camera), '');
  assert.equal(pictureText({ ...camera, refused: '/dev/video0: in use by guvcview (process 1234)' }), 'In use by guvcview (process 1234)');
  assert.equal(pictureText({ ...camera, refused: '/dev/video0: in use by another process; `fuser -v /dev/video0` shows it' }), 'In use by another process');
  assert.equal(pictureText({ ...camera, refused: '/dev/video0: its driver does not answer; unplug the device, or restart the board' }), 'Does not answer');
  assert.equal(pictureText({ ...camera, refused: '/dev/video0: permission denied' }), 'No picture');
});

test('the files in use say which camera is used, by any of its names', () => {
  const other = { ...camera, path: '/dev/video2', name: '/dev/video2', by_id: '', by_path: '', used: true };
  for (const device of [camera.path, camera.name, camera.by_path!]) assert.deepEqual(withUsed([camera, other], device).map(({ used }) => used), [true, false]);
  for (const device of ['', '/dev/video7']) assert.deepEqual(withUsed([camera, other], device).map(({ used }) => used), [false, true]);
});

test('sizes and rates are written as a person reads them', () => {
  assert.equal(sizeText({ width_px: 640, height_px: 480 }), '640 × 480');
  assert.equal(sizeText({ width_px: 32, height_px: 32, max_width_px: 1456, max_height_px: 1088 }), '32 × 32 to 1456 × 1088');
  assert.equal(rateText({ width_px: 1, height_px: 1, rates_hz: [30, 60, 25.00001] }), '60, 30, 25 Hz');
  assert.equal(rateText({ width_px: 1, height_px: 1, rate_range_hz: [1, 60.38] }), '1 to 60.4 Hz');
  assert.equal(rateText({ width_px: 1, height_px: 1, rates_hz: [] }), 'rate unknown');
});

test('ports that are plugged in come first, and numbered names are told from lasting ones', () => {
  const ports = [
    { path: '/dev/ttyACM0', name: '/dev/ttyACM0', kind: 'usb', refused: 'permission denied' },
    { path: '/dev/ttyS10', name: '/dev/ttyS10', kind: 'native' },
    { path: '/dev/ttyS2', name: '/dev/ttyS2', kind: 'native' },
    { path: '/dev/ttyUSB0', name: '/dev/serial/by-id/usb-R', kind: 'usb' },
  ];
  assert.deepEqual(sortedPorts(ports).map(({ path }) => path), ['/dev/ttyUSB0', '/dev/ttyS2', '/dev/ttyS10', '/dev/ttyACM0']);
  assert.equal(portNamed(ports, '/dev/ttyUSB0')?.name, '/dev/serial/by-id/usb-R');
  assert.equal(portNamed(ports, '/dev/ttyUSB1'), undefined);
  assert.deepEqual(['/dev/ttyUSB0', '/dev/ttyACM3', '/dev/ttyS0', '/dev/ttyAMA0', '/dev/serial/by-id/usb-R'].map(isNumbered), [true, true, false, false, false]);
});

test('GPIO chips are named by their label', () => {
  assert.match(chipText([{ path: '/dev/gpiochip0', label: 'pinctrl-rp1', line_count: 54 }, { path: '/dev/gpiochip1', refused: '/dev/gpiochip1: permission denied' }]), /pinctrl-rp1 \(54 lines\), \/dev\/gpiochip1: permission denied/);
  assert.equal(chipText([]), 'GPIO chips: none.');
});

test('while another page asks for the list, it is asked for again; any other refusal is told', async () => {
  const answers = [new Response('Devices are being listed already.\n', { status: 503 }), new Response('{"cameras": []}')];
  const asked: unknown[] = [];
  const get = (async (path: unknown) => (asked.push(path), answers.shift())) as typeof fetch;
  assert.deepEqual(await fetchDevices('/devices', get, 0), { cameras: [] });
  assert.deepEqual(asked, ['/devices', '/devices']);
  await assert.rejects(fetchDevices('/ports', (async () => new Response('', { status: 500 })) as typeof fetch, 0), /status 500/);
});
