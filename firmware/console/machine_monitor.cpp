#include "firmware/console/machine_monitor.h"

#include <sys/resource.h>
#include <unistd.h>
#include <cstdio>
#include <memory>

namespace touchline::console {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

double processor_time_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds_of = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

std::optional<double> temperature_c() {
  // Temperature in thousandths of a degree; on single-board computers this zone is the processor's.
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen("/sys/class/thermal/thermal_zone0/temp", "re"));
  long value = 0;
  if (file == nullptr || std::fscanf(file.get(), "%ld", &value) != 1) return std::nullopt;
  return static_cast<double>(value) / 1000.0;
}

double resident_memory_mb() {
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen("/proc/self/statm", "re"));
  long total = 0, resident = 0;
  if (file == nullptr || std::fscanf(file.get(), "%ld %ld", &total, &resident) != 2) return 0.0;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

void MachineMonitor::measure(Instant now) {
  const double cpu_s = processor_time_s(), passed_s = seconds(now - measured_);
  const bool has_before = measured_ != Instant{};
  if (has_before && passed_s > 0.0) status_.cpu_percent = 100.0 * (cpu_s - cpu_s_) / passed_s;
  cpu_s_ = cpu_s;
  measured_ = now;
  if (is_reading_) {  // the last reading has not ended within a second
    status_.temperature_c.reset();
    return;
  }
  is_reading_ = true;
  files_.run([this]() -> FileThread::Finish {
    const std::optional<double> temperature = temperature_c();
    const double memory_mb = resident_memory_mb();
    return [this, temperature, memory_mb] {
      is_reading_ = false;
      status_.temperature_c = temperature;
      status_.memory_mb = memory_mb;
    };
  });
}

}  // namespace touchline::console
