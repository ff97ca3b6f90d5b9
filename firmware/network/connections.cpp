#include "firmware/network/connections.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace touchline::network {
namespace {

std::uint64_t value(const std::atomic<std::uint64_t>& count) { return count.load(std::memory_order_relaxed); }

struct NamedCount {
  const char* name;
  std::uint64_t count;
};

// Returns text such as "sent 1200, lost 3"; counts of zero are omitted unless they are the first.
template <std::size_t kCount>
std::string text_of(const std::array<NamedCount, kCount>& counts) {
  std::string text;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (i > 0 && counts[i].count == 0) continue;
    text += (i > 0 ? ", " : "") + std::string(counts[i].name) + " " + std::to_string(counts[i].count);
  }
  return text;
}

std::array<NamedCount, 2> counts_of(const PublisherOutput& output) {
  return {{{"sent", output.sent()}, {"not sent", output.not_sent()}}};
}

std::array<NamedCount, 7> counts_of(const ReceiverInput& input) {
  const InputCounts& counts = input.counts();
  return {{{"received", value(counts.accepted)},
           {"of refused senders", value(counts.refused)},
           {"malformed", value(counts.malformed)},
           {"over the rate", value(counts.over_rate)},
           {"of a referee without effect", value(counts.without_effect)},
           {"for the other team", value(counts.other_team)},
           {"for unknown robots", value(counts.unknown_robot)}}};
}

// Adds up the counts of several outputs or inputs. Empty if there are none.
template <class List>
std::string total_text(const List& list) {
  if (list.empty()) return {};
  auto total = counts_of(*list.front());
  for (std::size_t i = 1; i < list.size(); ++i) {
    const auto counts = counts_of(*list[i]);
    for (std::size_t j = 0; j < counts.size(); ++j) total[j].count += counts[j].count;
  }
  return text_of(total);
}

}  // namespace

bool Connections::has_input(bool of_referee) const {
  return std::any_of(plan_.inputs.begin(), plan_.inputs.end(), [of_referee](const PlannedInput& input) {
    return config::is_referee(input.protocol) == of_referee;
  });
}

void Connections::attach(Session& session) {
  session.set_snapshots(snapshots_.get());
  if (has_input(false)) session.set_arena_objects(arena_objects_);
  ExternalInputSettings external;
  if (has_input(false)) external.commands = commands_.get();
  if (has_input(true)) {
    external.referee = referee_.get();
    external.referee_releases = &referee_releases_;
    external.awaits_referee = true;
  }
  if (const std::optional<TeamColor> own = own_color(session.configuration().team)) {
    external.own_is_yellow = *own == TeamColor::kYellow;
  }
  session.set_external_input(external);
}

void Connections::start(const config::Configuration& configuration, const Print& print) {
  const PublishedScene scene = published_scene(configuration);
  if (!plan_.outputs.empty()) {
    publisher_ = std::make_unique<Publisher>(*snapshots_, make_outputs(plan_, configuration, print), scene, print);
  }
  if (!plan_.inputs.empty()) {
    std::vector<RobotId> robots;
    for (const RobotMarking& robot : configuration.pipeline.marker.teams[0].robots) robots.push_back(robot.id);
    receiver_ = std::make_unique<Receiver>(make_inputs(plan_, configuration), scene.own, std::move(robots), *commands_,
                                           *referee_, referee_releases_, print, arena_objects_);
  }
}

void Connections::stop() {
  if (publisher_) publisher_->end();
  if (receiver_) receiver_->end();
}

std::string Connections::start_text() const {
  std::string text = describe(plan_);
  if (publisher_) text += "time: " + hal::describe(publisher_->unix_time()) + "\n";
  return text;
}

std::string Connections::status_text() const {
  std::string text;
  if (publisher_) {
    text += "  network: " + total_text(publisher_->outputs());
    if (publisher_->lost() > 0) text += ", snapshots lost " + std::to_string(publisher_->lost());
  }
  if (receiver_) text += (text.empty() ? "  network: " : ", ") + total_text(receiver_->inputs());
  if (publisher_) text += ", " + hal::short_text(publisher_->unix_time());
  return text;
}

std::string Connections::summary() const {
  std::string text;
  if (publisher_) {
    for (const auto& output : publisher_->outputs()) {
      text += "output    " + output->name() + ": " + text_of(counts_of(*output)) + "\n";
    }
    if (publisher_->lost() > 0) {
      text += "output    " + std::to_string(publisher_->lost()) + " snapshots lost: the publisher was too slow\n";
    }
  }
  if (receiver_) {
    for (const auto& input : receiver_->inputs()) {
      text += "input     " + input->name() + ": " + text_of(counts_of(*input)) + "\n";
    }
  }
  return text;
}

std::string describe(const NetworkPlan& plan) {
  std::string text;
  for (const PlannedOutput& output : plan.outputs) text += "publish: " + describe(output) + "\n";
  for (const PlannedInput& input : plan.inputs) text += "accept: " + describe(input) + "\n";
  return text;
}

}  // namespace touchline::network
