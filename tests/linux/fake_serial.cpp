#include "tests/linux/fake_serial.h"

#include <libserialport.h>
#include <linux/serial.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>

#include "tests/linux/driver_allocations.h"

namespace touchline::fake {
namespace {

SerialPorts* machine = nullptr;

SerialPort& port_of(const sp_port* port) { return *reinterpret_cast<SerialPort*>(const_cast<sp_port*>(port)); }

sp_return to_sp_return(int result) {
  if (result >= 0) return static_cast<sp_return>(result);
  machine->last_error = -result;
  return SP_ERR_FAIL;
}

}  // namespace

SerialPorts::SerialPorts(std::vector<SerialPort*> ports) : ports_(std::move(ports)) { machine = this; }
SerialPorts::~SerialPorts() { machine = nullptr; }

SerialPort* SerialPorts::find(const std::string& path) const {
  const auto found =
      std::find_if(ports_.begin(), ports_.end(), [&](const SerialPort* port) { return port->path() == path; });
  return found == ports_.end() ? nullptr : *found;
}

int SerialPort::ioctl(unsigned long request, void* argument) {
  if (request == TIOCEXCL) {
    exclusive = true;
    return 0;
  }
  constexpr auto kFlag = static_cast<int>(ASYNC_LOW_LATENCY);
  auto* const line = static_cast<serial_struct*>(argument);
  if (request == TIOCGSERIAL) {
    line->flags = low_latency ? kFlag : 0;
  } else if (request == TIOCSSERIAL) {
    low_latency = offers_low_latency && (line->flags & kFlag) != 0;
  } else {
    return -ENOTTY;
  }
  return 0;
}

int SerialPort::open_port() {
  if (open_error != 0) return -open_error;
  number_ = kernel()->adopt(*this);
  sent_until_ = kernel()->now();
  return 0;
}

void SerialPort::close_port() {
  kernel()->close(number_);
  number_ = -1;
}

/// Moves bytes to the wire, ten bits per byte.
void SerialPort::transmit() {
  if (stalled || baud == 0) {
    sent_until_ = kernel()->now();
    return;
  }
  const Duration byte_time = from_seconds(10.0 / baud);
  while (!buffer_.empty() && sent_until_ + byte_time <= kernel()->now()) {
    wire_.push_back(buffer_.front());
    buffer_.erase(buffer_.begin());
    sent_until_ += byte_time;
  }
  if (buffer_.empty()) sent_until_ = kernel()->now();
}

int SerialPort::write(const std::byte* bytes, std::size_t count) {
  if (error_ != 0) return -error_;
  if (write_error != 0) return -write_error;
  transmit();
  const std::size_t taken = std::min(count, buffer_bytes - std::min(buffer_bytes, buffer_.size()));
  buffer_.insert(buffer_.end(), bytes, bytes + taken);
  return static_cast<int>(taken);
}

int SerialPort::read(std::byte* bytes, std::size_t count) {
  if (read_error != 0) return -read_error;
  const std::size_t taken = std::min(count, received_.size());
  std::copy_n(received_.begin(), taken, bytes);
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(taken));
  return static_cast<int>(taken);  // 0 after a hang-up too: end of file
}

int SerialPort::output_waiting() {
  if (error_ != 0) return -error_;
  transmit();
  return static_cast<int>(buffer_.size() - std::min(buffer_.size(), chip_bytes));
}

int SerialPort::flush() {
  if (error_ != 0) return -error_;
  transmit();
  if (!flushes) return 0;
  flushed_ += buffer_.size();
  buffer_.clear();
  return 0;
}

const std::vector<std::byte>& SerialPort::wire() {
  transmit();
  return wire_;
}

std::size_t SerialPort::waiting() {
  transmit();
  return buffer_.size();
}

}  // namespace touchline::fake

using touchline::fake::machine;
using touchline::fake::port_of;
using touchline::testing::UncountedAllocations;

extern "C" {

sp_return __wrap_sp_get_port_by_name(const char* name, sp_port** port) {
  *port = reinterpret_cast<sp_port*>(machine->find(name));
  if (*port == nullptr) return SP_ERR_ARG;
  ++machine->unfreed;
  return SP_OK;
}
void __wrap_sp_free_port(sp_port*) { --machine->unfreed; }

sp_return __wrap_sp_list_ports(sp_port*** list) {
  *list = new sp_port*[machine->all().size() + 1]();
  ++machine->unfreed;
  for (std::size_t i = 0; i < machine->all().size(); ++i) {
    (*list)[i] = reinterpret_cast<sp_port*>(machine->all()[i]);
  }
  return SP_OK;
}
void __wrap_sp_free_port_list(sp_port** list) {
  delete[] list;
  --machine->unfreed;
}
char* __wrap_sp_get_port_name(const sp_port* port) { return const_cast<char*>(port_of(port).path().c_str()); }
char* __wrap_sp_get_port_description(const sp_port* port) { return port_of(port).description.data(); }

sp_transport __wrap_sp_get_port_transport(const sp_port* port) {
  if (port_of(port).is_bluetooth) return SP_TRANSPORT_BLUETOOTH;
  return port_of(port).usb_vendor < 0 ? SP_TRANSPORT_NATIVE : SP_TRANSPORT_USB;
}
sp_return __wrap_sp_get_port_usb_vid_pid(const sp_port* port, int* vendor, int* product) {
  *vendor = port_of(port).usb_vendor;
  *product = port_of(port).usb_product;
  return *vendor < 0 ? SP_ERR_ARG : SP_OK;
}

sp_return __wrap_sp_open(sp_port* port, sp_mode) { return touchline::fake::to_sp_return(port_of(port).open_port()); }
sp_return __wrap_sp_close(sp_port* port) {
  port_of(port).close_port();
  return SP_OK;
}
sp_return __wrap_sp_get_port_handle(const sp_port* port, void* handle) {
  *static_cast<int*>(handle) = port_of(port).number();
  return SP_OK;
}
int __wrap_sp_last_error_code() { return machine->last_error; }

sp_return __wrap_sp_set_baudrate(sp_port* port, int baud) {
  auto& own = port_of(port);
  if (own.baud_error != 0) return touchline::fake::to_sp_return(-own.baud_error);
  own.baud = own.actual_baud != 0 ? own.actual_baud : baud;
  return SP_OK;
}
sp_return __wrap_sp_set_bits(sp_port* port, int bits) {
  auto& own = port_of(port);
  if (own.bits_error != 0) return touchline::fake::to_sp_return(-own.bits_error);
  own.bits = bits;
  return SP_OK;
}
sp_return __wrap_sp_set_parity(sp_port* port, sp_parity parity) {
  port_of(port).parity = parity;
  return SP_OK;
}
sp_return __wrap_sp_set_stopbits(sp_port* port, int bits) {
  port_of(port).stop_bits = bits;
  return SP_OK;
}
sp_return __wrap_sp_set_flowcontrol(sp_port* port, sp_flowcontrol control) {
  port_of(port).flow_control = control;
  return SP_OK;
}
sp_return __wrap_sp_new_config(sp_port_config** config) {
  *config = reinterpret_cast<sp_port_config*>(new int(0));
  ++machine->unfreed;
  return SP_OK;
}
void __wrap_sp_free_config(sp_port_config* config) {
  delete reinterpret_cast<int*>(config);
  --machine->unfreed;
}
sp_return __wrap_sp_get_config(sp_port* port, sp_port_config* config) {
  *reinterpret_cast<int*>(config) = port_of(port).baud;
  return SP_OK;
}
sp_return __wrap_sp_get_config_baudrate(const sp_port_config* config, int* baud) {
  *baud = *reinterpret_cast<const int*>(config);
  return SP_OK;
}

sp_return __wrap_sp_nonblocking_write(sp_port* port, const void* bytes, std::size_t count) {
  const UncountedAllocations uncounted;
  return touchline::fake::to_sp_return(port_of(port).write(static_cast<const std::byte*>(bytes), count));
}
sp_return __wrap_sp_nonblocking_read(sp_port* port, void* bytes, std::size_t count) {
  const UncountedAllocations uncounted;
  return touchline::fake::to_sp_return(port_of(port).read(static_cast<std::byte*>(bytes), count));
}
sp_return __wrap_sp_output_waiting(sp_port* port) {
  const UncountedAllocations uncounted;
  return touchline::fake::to_sp_return(port_of(port).output_waiting());
}
sp_return __wrap_sp_flush(sp_port* port, sp_buffer) {
  const UncountedAllocations uncounted;
  return touchline::fake::to_sp_return(port_of(port).flush());
}

}  // extern "C"
