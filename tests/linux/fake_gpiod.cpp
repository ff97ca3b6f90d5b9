#include "tests/linux/fake_gpiod.h"

#include <gpiod.h>

#include <cerrno>
#include <set>

// libgpiod's handles, which its users never look into.
struct gpiod_chip {
  touchline::fake::GpioChip* chip;
  std::set<gpiod_line*> lines;
};
struct gpiod_line {
  touchline::fake::GpioChip* chip;
  unsigned offset;
  bool requested;
};
struct gpiod_chip_iter {
  std::size_t next;
};

namespace touchline::fake {
namespace {
GpioChips* machine = nullptr;
}

GpioChips::GpioChips(std::vector<GpioChip*> chips) : chips_(std::move(chips)) { machine = this; }
GpioChips::~GpioChips() { machine = nullptr; }

}  // namespace touchline::fake

using touchline::fake::GpioChip;
using touchline::fake::machine;

namespace {

gpiod_chip* handle(GpioChip* chip) {
  ++machine->unclosed;
  return new gpiod_chip{chip, {}};
}

int request(gpiod_line* line, const char* consumer, bool output, int flags, int level) {
  GpioChip& chip = *line->chip;
  if (chip.request_error != 0) {
    errno = chip.request_error;
    return -1;
  }
  GpioChip::Pin& pin = chip.pins[line->offset];
  if (!pin.holder.empty()) {
    errno = EBUSY;
    return -1;
  }
  pin.holder = consumer;
  pin.output = output;
  pin.flags = flags;
  pin.level = level;
  line->requested = true;
  return 0;
}

}  // namespace

extern "C" {

gpiod_chip* __wrap_gpiod_chip_open(const char* path) {
  for (GpioChip* chip : machine->all()) {
    if ("/dev/" + chip->name != path) continue;
    errno = chip->open_error;
    return chip->open_error != 0 ? nullptr : handle(chip);
  }
  errno = ENOENT;
  return nullptr;
}

void __wrap_gpiod_chip_close(gpiod_chip* chip) {
  for (gpiod_line* line : chip->lines) {
    if (line->requested) line->chip->pins[line->offset].holder.clear();
    delete line;
  }
  delete chip;
  --machine->unclosed;
}

const char* __wrap_gpiod_chip_name(gpiod_chip* chip) { return chip->chip->name.c_str(); }
const char* __wrap_gpiod_chip_label(gpiod_chip* chip) { return chip->chip->label.c_str(); }
unsigned __wrap_gpiod_chip_num_lines(gpiod_chip* chip) { return chip->chip->lines; }

gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip* chip, unsigned offset) {
  if (offset >= chip->chip->lines) {
    errno = EINVAL;
    return nullptr;
  }
  return *chip->lines.insert(new gpiod_line{chip->chip, offset, false}).first;
}

const char* __wrap_gpiod_line_consumer(gpiod_line* line) {
  const std::string& holder = line->chip->pins[line->offset].holder;
  return holder.empty() ? nullptr : holder.c_str();
}

int __wrap_gpiod_line_request_output(gpiod_line* line, const char* consumer, int level) {
  return request(line, consumer, true, 0, level);
}
int __wrap_gpiod_line_request_input_flags(gpiod_line* line, const char* consumer, int flags) {
  return request(line, consumer, false, flags, 0);
}

int __wrap_gpiod_line_set_value(gpiod_line* line, int level) {
  if (line->chip->value_error != 0 || !line->requested) {
    errno = line->requested ? line->chip->value_error : EPERM;
    return -1;
  }
  line->chip->pins[line->offset].level = level;
  return 0;
}

int __wrap_gpiod_line_get_value(gpiod_line* line) {
  if (line->chip->value_error != 0 || !line->requested) {
    errno = line->requested ? line->chip->value_error : EPERM;
    return -1;
  }
  const GpioChip::Pin& pin = line->chip->pins[line->offset];
  const int pulled = (pin.flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP) != 0 ? 1 : 0;
  const int level = pin.driven >= 0 ? pin.driven : pulled;
  return (pin.flags & GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW) != 0 ? 1 - level : level;
}

gpiod_chip_iter* __wrap_gpiod_chip_iter_new() {
  ++machine->unclosed;
  return new gpiod_chip_iter{0};
}
gpiod_chip* __wrap_gpiod_chip_iter_next(gpiod_chip_iter* iterator) {
  // As the library: the one before is closed by the next.
  static gpiod_chip* open = nullptr;
  if (open != nullptr) __wrap_gpiod_chip_close(open);
  open = iterator->next < machine->all().size() ? handle(machine->all()[iterator->next++]) : nullptr;
  return open;
}
void __wrap_gpiod_chip_iter_free(gpiod_chip_iter* iterator) {
  delete iterator;
  --machine->unclosed;
}

}  // extern "C"
