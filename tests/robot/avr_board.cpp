#include "tests/robot/avr_board.h"

#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace touchline::testing {
namespace {

constexpr std::uint32_t kClockHz = 16000000;
constexpr std::int64_t kCyclesPerUs = kClockHz / 1000000;
// simavr 1.6 reads a byte every 11 bits, as if there was always a parity bit, and loses bytes that come faster.
constexpr int kBitsPerByte = 12;
// Registers of the ATmega328P by their address in the data memory (datasheet, chapter "Register Summary").
constexpr std::size_t kPortB = 0x25, kPortD = 0x2B, kTccr1a = 0x80, kOcr1a = 0x88, kOcr1b = 0x8A, kUcsr0b = 0xC1;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "tests/robot/avr_board.cpp: %s\n", what.c_str());
  std::abort();
}

}  // namespace

struct AvrBoard::Simulator {
  avr_t* avr = nullptr;
  avr_irq_t* uart_input = nullptr;
  bool line_is_busy = false;
  avr_cycle_count_t byte_cycles = 0;

  [[nodiscard]] unsigned reg(std::size_t address) const { return avr->data[address]; }
  [[nodiscard]] bool bit(std::size_t address, unsigned number) const { return (reg(address) >> number & 1U) != 0; }
  // 0 to 255: the compare value if the timer drives the pin, otherwise the pin's level.
  [[nodiscard]] int pwm(unsigned timer_bit, std::size_t compare, unsigned pin) const {
    if (bit(kTccr1a, timer_bit)) return static_cast<int>(reg(compare));
    return bit(kPortB, pin) ? 255 : 0;
  }
  static int with_direction(int pwm, bool forward, bool backward) {
    if (forward == backward) return pwm == 0 && !forward ? 0 : kContradiction;
    return forward ? pwm : -pwm;
  }

  static avr_cycle_count_t next_byte(avr_t*, avr_cycle_count_t when, void* board) {
    return static_cast<AvrBoard*>(board)->simulator_->feed(*static_cast<AvrBoard*>(board), when);
  }
  avr_cycle_count_t feed(AvrBoard& board, avr_cycle_count_t when) {
    if (board.line_.empty()) {
      line_is_busy = false;
      return 0;
    }
    avr_raise_irq(uart_input, std::to_integer<std::uint32_t>(board.line_.front()));
    board.line_.pop_front();
    return when + byte_cycles;
  }
  static void on_output(avr_irq_t*, std::uint32_t value, void* board) {
    auto& self = *static_cast<AvrBoard*>(board);
    self.sent_.push_back({static_cast<std::byte>(value), self.now_us()});
  }
};

AvrBoard::AvrBoard(const std::string& flash, int baud) : simulator_(std::make_unique<Simulator>()) {
  std::ifstream file(flash, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) fail(flash + " cannot be read");
  avr_t* avr = avr_make_mcu_by_name("atmega328p");
  if (avr == nullptr) fail("simavr does not know the atmega328p");
  simulator_->avr = avr;
  simulator_->byte_cycles = kClockHz * kBitsPerByte / static_cast<unsigned>(baud);
  avr_init(avr);
  avr->frequency = kClockHz;
  avr->log = LOG_ERROR;
  avr->avcc = avr->vcc = avr->aref = 5000;
  // Without this, it waits in real time when the sketch sleeps.
  avr->sleep = [](avr_t*, avr_cycle_count_t) {};
  if (bytes.size() > avr->flashend) fail(flash + " is too large for the flash memory");
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(avr->flash));
  avr->codeend = avr->flashend;

  // Neither prints what the sketch sends, nor waits in real time when the sketch waits for a byte.
  std::uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  simulator_->uart_input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), Simulator::on_output, this);
  constexpr unsigned kReceiveInterrupt = 7;
  for (int ms = 0; !simulator_->bit(kUcsr0b, kReceiveInterrupt); ++ms) {
    if (ms > 100) fail("the sketch does not open its serial port");
    run_us(1000);
  }
}

AvrBoard::~AvrBoard() {
  avr_terminate(simulator_->avr);
  std::free(simulator_->avr);
}

std::int64_t AvrBoard::now_us() const { return static_cast<std::int64_t>(simulator_->avr->cycle) / kCyclesPerUs; }

void AvrBoard::run_us(std::int64_t time_us) {
  const avr_cycle_count_t end = simulator_->avr->cycle + static_cast<avr_cycle_count_t>(time_us * kCyclesPerUs);
  while (simulator_->avr->cycle < end) {
    const int state = avr_run(simulator_->avr);
    if (state == cpu_Done || state == cpu_Crashed) fail("the sketch has crashed");
  }
}

void AvrBoard::send(std::span<const std::byte> bytes) {
  line_.insert(line_.end(), bytes.begin(), bytes.end());
  if (simulator_->line_is_busy || line_.empty()) return;
  simulator_->line_is_busy = true;
  avr_cycle_timer_register(simulator_->avr, simulator_->byte_cycles, Simulator::next_byte, this);
}

void AvrBoard::send_all(std::span<const std::byte> bytes) {
  send(bytes);
  while (simulator_->line_is_busy) run_us(100);
  run_us(1500);
}

MotorPins AvrBoard::motors() const {
  const Simulator& s = *simulator_;
  // Arduino's pins 2, 4, 5, 6 are PD2 to PD6; 9 is PB1 and OC1A, 10 is PB2 and OC1B.
  return {Simulator::with_direction(s.pwm(7, kOcr1a, 1), s.bit(kPortD, 2), s.bit(kPortD, 4)),
          Simulator::with_direction(s.pwm(5, kOcr1b, 2), s.bit(kPortD, 5), s.bit(kPortD, 6))};
}

void AvrBoard::set_a0(unsigned millivolts) {
  avr_raise_irq(avr_io_getirq(simulator_->avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0), millivolts);
}

}  // namespace touchline::testing
