#include "tools/programs/latency/interrupts.h"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace touchline::latency {
namespace {

// Returns the numbers of the processors in the columns of the head line: "CPU0       CPU1".
std::vector<std::size_t> columns_of(const std::string& head) {
  std::vector<std::size_t> columns;
  std::istringstream words(head);
  for (std::string word; words >> word;) {
    if (word.starts_with("CPU")) columns.push_back(static_cast<std::size_t>(std::atoi(word.c_str() + 3)));
  }
  return columns;
}

std::string trimmed(const std::string& text) {
  std::string out;
  std::istringstream words(text);
  for (std::string word; words >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

// Returns "virtio1-req.0 (36)" for the line "  36:  0  1845082  PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0".
std::string name_of(const std::string& label, const std::string& rest) {
  const bool is_device = !label.empty() && label.find_first_not_of("0123456789") == std::string::npos;
  const std::string text = trimmed(rest);
  if (!is_device) return text.empty() ? label : text;
  const std::size_t device = text.rfind(' ');
  return device == std::string::npos ? label : text.substr(device + 1) + " (" + label + ")";
}

// Returns the processor's own count of system management interrupts (Intel: MSR_SMI_COUNT).
std::optional<std::uint64_t> read_management_count(const std::string& root, std::size_t processor) {
  const int file = ::open((root + "/dev/cpu/" + std::to_string(processor) + "/msr").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  constexpr off_t kRegister = 0x34;
  std::uint64_t value = 0;
  const bool is_read = ::pread(file, &value, sizeof value, kRegister) == sizeof value;
  ::close(file);
  if (!is_read) return std::nullopt;
  return value & 0xffffffffU;  // the other bits are reserved
}

}  // namespace

InterruptCounts read_interrupts(const std::string& root) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return {};
  InterruptCounts counts;
  std::ifstream file(root + "/proc/interrupts");
  std::string line;
  std::getline(file, line);
  const std::vector<std::size_t> processors = columns_of(line);
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string label, rest;
    if (!(words >> label) || label.back() != ':') continue;
    label.pop_back();
    std::uint64_t sum = 0, value = 0;
    std::size_t column = 0;
    for (; column < processors.size() && words >> value; ++column) {
      if (CPU_ISSET(processors[column], &allowed)) sum += value;
    }
    // "ERR" and "MIS" are not counted by processor.
    if (column < processors.size()) continue;
    std::getline(words, rest);
    counts.by_name[name_of(label, rest)] += sum;
    if (label == "NMI") counts.non_maskable = sum;
  }
  for (const std::size_t processor : processors) {
    if (!CPU_ISSET(processor, &allowed)) continue;
    if (const auto count = read_management_count(root, processor)) {
      counts.system_management = std::max(counts.system_management.value_or(0), *count);
    }
  }
  return counts;
}

std::vector<InterruptCount> interrupts_between(const InterruptCounts& begin, const InterruptCounts& end) {
  std::vector<InterruptCount> happened;
  for (const auto& [name, count] : end.by_name) {
    const auto before = begin.by_name.find(name);
    const std::uint64_t since = count - (before == begin.by_name.end() ? 0 : std::min(before->second, count));
    if (since > 0) happened.push_back({name, since});
  }
  std::stable_sort(happened.begin(), happened.end(),
                   [](const InterruptCount& a, const InterruptCount& b) { return a.count > b.count; });
  return happened;
}

}  // namespace touchline::latency
