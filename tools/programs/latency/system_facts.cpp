#include "tools/programs/latency/system_facts.h"

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>

namespace touchline::latency {
namespace {

std::string line_of(const std::string& path) {
  std::string line;
  std::getline(std::ifstream(path), line, '\n');
  while (!line.empty() && (line.back() == '\0' || line.back() == ' ')) line.pop_back();
  return line;
}

std::optional<double> scaled_number(const std::string& path, double scale) {
  double value = 0.0;
  if (std::ifstream(path) >> value) return value * scale;
  return std::nullopt;
}

// Returns the rest of the first line that begins with `key`, as in "model name : AMD EPYC".
std::string value_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t begin = line.find_first_not_of(" \t:", key.size());
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return "";
}

// Formats a set of processors as the kernel does: "0-3,6".
std::string list_of(const cpu_set_t& set) {
  std::string list;
  for (std::size_t i = 0; i < CPU_SETSIZE; ++i) {
    if (!CPU_ISSET(i, &set)) continue;
    std::size_t last = i;
    while (last + 1 < CPU_SETSIZE && CPU_ISSET(last + 1, &set)) ++last;
    list += (list.empty() ? "" : ",") + std::to_string(i) + (last > i ? "-" + std::to_string(last) : "");
    i = last;
  }
  return list;
}

const char* name_of_policy(int policy) {
  switch (policy) {
    case SCHED_OTHER:
      return "SCHED_OTHER";
    case SCHED_FIFO:
      return "SCHED_FIFO";
    case SCHED_RR:
      return "SCHED_RR";
    case SCHED_BATCH:
      return "SCHED_BATCH";
    case SCHED_IDLE:
      return "SCHED_IDLE";
    default:
      return "unknown policy";
  }
}

std::string preemption_of(const std::string& root) {
  if (line_of(root + "/sys/kernel/realtime") == "1") return "PREEMPT_RT";
  // for example "#1 SMP PREEMPT_DYNAMIC Debian 6.1.90-1"
  const std::string version = line_of(root + "/proc/sys/kernel/version");
  const std::size_t begin = version.find("PREEMPT");
  return begin == std::string::npos ? "no PREEMPT" : version.substr(begin, version.find(' ', begin) - begin);
}

std::string frequency_path(const std::string& root) {
  return root + "/sys/devices/system/cpu/cpu" + std::to_string(std::max(0, sched_getcpu())) + "/cpufreq/";
}

std::optional<double> hottest_celsius(const std::string& root) {
  std::optional<double> hottest;
  std::error_code error;
  for (const auto& zone : std::filesystem::directory_iterator(root + "/sys/class/thermal", error)) {
    if (!zone.path().filename().string().starts_with("thermal_zone")) continue;
    const auto celsius = scaled_number(zone.path() / "temp", 1e-3);
    if (celsius) hottest = std::max(hottest.value_or(*celsius), *celsius);
  }
  return hottest;
}

}  // namespace

SystemFacts read_system_facts(const std::string& root) {
  SystemFacts facts;
  // The device tree has the name of a board; PCs only have the name of the processor.
  facts.processor = line_of(root + "/proc/device-tree/model");
  if (facts.processor.empty()) facts.processor = value_of(root + "/proc/cpuinfo", "model name");
  std::ifstream cpuinfo(root + "/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) facts.processors += line.starts_with("processor\t") ? 1u : 0u;
  facts.kernel = line_of(root + "/proc/sys/kernel/osrelease");
  facts.preemption = preemption_of(root);
  facts.isolated = line_of(root + "/sys/devices/system/cpu/isolated");

  facts.scheduler = name_of_policy(sched_getscheduler(0));
  sched_param parameters{};
  if (sched_getparam(0, &parameters) == 0) facts.priority = parameters.sched_priority;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) facts.affinity = list_of(set);
  facts.timer_slack_ns = prctl(PR_GET_TIMERSLACK);
  facts.locked_kb = std::atoll(value_of(root + "/proc/self/status", "VmLck:").c_str());

  const std::string frequency = frequency_path(root);
  facts.governor = line_of(frequency + "scaling_governor");
  facts.min_mhz = scaled_number(frequency + "scaling_min_freq", 1e-3);
  facts.max_mhz = scaled_number(frequency + "scaling_max_freq", 1e-3);
  facts.begin_mhz = scaled_number(frequency + "scaling_cur_freq", 1e-3);
  facts.begin_celsius = hottest_celsius(root);
  return facts;
}

void read_final_facts(SystemFacts& facts, const std::string& root) {
  facts.end_mhz = scaled_number(frequency_path(root) + "scaling_cur_freq", 1e-3);
  facts.end_celsius = hottest_celsius(root);
}

std::optional<ProcessorTimes> read_processor_times(const std::string& root) {
  enum {
    kUserTicks,
    kNiceTicks,
    kSystemTicks,
    kIdleTicks,
    kIoWaitTicks,
    kInterruptTicks,
    kSoftInterruptTicks,
    kStolenTicks,
    kTickColumns
  };
  std::array<double, kTickColumns> ticks{};
  std::ifstream file(root + "/proc/stat");
  std::string name;
  if (!(file >> name) || name != "cpu") return std::nullopt;
  for (double& column : ticks) {
    if (!(file >> column)) return std::nullopt;
  }
  const double tick_s = 1.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
  rusage own{};
  getrusage(RUSAGE_SELF, &own);
  const auto seconds_of = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  using Seconds = std::chrono::duration<double>;
  return ProcessorTimes{(ticks[kUserTicks] + ticks[kNiceTicks] + ticks[kSystemTicks] + ticks[kInterruptTicks] +
                         ticks[kSoftInterruptTicks]) *
                            tick_s,
                        ticks[kStolenTicks] * tick_s, seconds_of(own.ru_utime) + seconds_of(own.ru_stime),
                        Seconds(std::chrono::steady_clock::now().time_since_epoch()).count()};
}

void add_load(SystemFacts& facts, const ProcessorTimes& begin, const ProcessorTimes& end) {
  constexpr double kShortest_s = 0.1;
  const double elapsed_s = end.elapsed_s - begin.elapsed_s;
  if (elapsed_s < kShortest_s) return;
  facts.others_busy = std::max(0.0, end.busy_s - begin.busy_s - (end.own_s - begin.own_s)) / elapsed_s;
  facts.stolen = (end.stolen_s - begin.stolen_s) / elapsed_s;
}

}  // namespace touchline::latency
