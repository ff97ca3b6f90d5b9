#include <libserialport.h>

#include <cerrno>

#include "tests/linux/fake_v4l2.h"
#include "tests/linux/serial_radio_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

TEST_F(SerialRadioTest, OpensRawAndExclusively) {
  SerialRadio radio(settings());
  ASSERT_OK(radio.open());
  EXPECT_EQ(radio.description(), text("115200 baud, low latency"));
  EXPECT_TRUE(adapter_.low_latency);
  EXPECT_EQ(adapter_.baud, 115200);
  EXPECT_EQ(adapter_.bits, 8);
  EXPECT_EQ(adapter_.parity, SP_PARITY_NONE);
  EXPECT_EQ(adapter_.stop_bits, 1);
  EXPECT_EQ(adapter_.flow_control, SP_FLOWCONTROL_NONE);
  EXPECT_TRUE(adapter_.exclusive);
}

TEST_F(SerialRadioTest, AMissingPortListsTheAvailablePorts) {
  RadioSettings requested = settings();
  requested.device = "/dev/ttyUSB7";
  expect_refusal(
      requested, ErrorCode::kNotFound,
      std::string(
          "/dev/ttyUSB7: no such port; available ports: /dev/ttyS0 (ttyS0), /dev/ttyUSB0 (FT232R USB UART) = ") +
          kById);
}

TEST_F(SerialRadioTest, AFileThatIsNotASerialPortIsRefused) {
  fake::VideoDevice camera;
  kernel_.add("/dev/video0", camera);
  RadioSettings requested = settings();
  requested.device = "/dev/video0";
  expect_refusal(
      requested, ErrorCode::kUnsupported,
      std::string(
          "/dev/video0: not a serial port; available ports: /dev/ttyS0 (ttyS0), /dev/ttyUSB0 (FT232R USB UART) = ") +
          kById);
}

// libserialport knows Bluetooth's ports but cannot set them up. They are opened as terminal_radio_test.cpp opens a
// terminal; this port has none behind it, so it is refused.
TEST_F(SerialRadioTest, ABluetoothPortIsOpenedAsATerminalAndNotByLibserialport) {
  fake::SerialPort bluetooth("/dev/rfcomm0");
  bluetooth.is_bluetooth = true;
  bluetooth.open_error = EBUSY;  // of libserialport
  kernel_.add("/dev/rfcomm0", bluetooth);
  fake::SerialPorts ports({&bluetooth});
  RadioSettings requested = settings();
  requested.device = "/dev/rfcomm0";
  const Result<void> opened = SerialRadio(requested).open();
  EXPECT_EQ(opened.code(), ErrorCode::kUnsupported);
  EXPECT_EQ(opened.text().find("/dev/rfcomm0: not a serial port"), 0U) << opened.text();
  EXPECT_EQ(ports.unfreed, 0);
}

TEST_F(SerialRadioTest, PermissionErrorsSayWhatToDo) {
  adapter_.open_error = EACCES;
  expect_refusal(
      settings(), ErrorCode::kPermission,
      text("permission denied; add the user to the group dialout (`sudo usermod -aG dialout $USER`) and log in "
           "again"));
  adapter_.open_error = EBUSY;
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 text(std::string("in use by another process; `fuser -v ") + kById + "` shows it"));
  adapter_.open_error = EIO;
  expect_refusal(
      settings(), ErrorCode::kNotFound,
      text(std::string(
               "no UART behind this port; available ports: /dev/ttyS0 (ttyS0), /dev/ttyUSB0 (FT232R USB UART) = ") +
           kById));
  adapter_.open_error = ENOMEM;
  expect_refusal(settings(), ErrorCode::kIo, text("cannot be opened: Cannot allocate memory"));
}

TEST_F(SerialRadioTest, APortLockedByAnotherProgramIsBusy) {
  adapter_.locked_by_another = true;
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 text(std::string("in use by another process; `fuser -v ") + kById + "` shows it"));
}

TEST_F(SerialRadioTest, UnsupportedBaudRatesAreRefused) {
  adapter_.baud_error = EINVAL;
  expect_refusal(settings(1234567), ErrorCode::kUnsupported, text("refuses baud = 1234567: Invalid argument"));
  adapter_.baud_error = 0;
  adapter_.actual_baud = 9600;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 text("baud = 115200: set to 9600, which is too far off for the robots to understand"));
  adapter_.actual_baud = 115200 - 2400;  // 2.1 % too slow
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 text("baud = 115200: set to 112800, which is too far off for the robots to understand"));
  adapter_.actual_baud = 115200 + 2200;  // 1.9 % too fast
  SerialRadio radio(settings());
  EXPECT_TRUE(radio.open().ok());
  EXPECT_EQ(radio.description(), text("115200 baud, set to 117400, low latency"));
}

TEST_F(SerialRadioTest, HighAndNonstandardBaudRatesAreSet) {
  for (const int baud : {1000000, 1234567, 4000000}) {
    SerialRadio radio(settings(baud));
    ASSERT_OK(radio.open());
    EXPECT_EQ(adapter_.baud, baud);
    EXPECT_EQ(radio.description(), text(std::to_string(baud) + " baud, low latency"));
  }
}

TEST_F(SerialRadioTest, DriversWithoutLowLatencyAreAccepted) {
  adapter_.offers_low_latency = false;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  EXPECT_EQ(radio.description(), text("115200 baud"));
}

TEST_F(SerialRadioTest, UnpluggingDuringTheSetupIsReported) {
  adapter_.bits_error = EIO;
  expect_refusal(settings(), ErrorCode::kDisconnected, text("the port went away (setting 8N1 without flow control)"));
  adapter_.bits_error = 0;
  adapter_.baud_error = ENODEV;
  expect_refusal(settings(), ErrorCode::kDisconnected, text("the port went away (setting the baud rate)"));
}

}  // namespace
}  // namespace touchline::testing
