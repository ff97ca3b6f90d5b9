#include "hal/files/text_output.h"

#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace touchline::hal {
namespace {

// Writes without stdio, because a thread that waits in fwrite() holds a lock that exit() takes.
void write_text(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;  // nobody can read the text: the program goes on
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

struct TextOutput::State {
  struct WaitingText {
    int descriptor;
    std::string text;
  };
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<WaitingText> waiting;
  std::size_t waiting_bytes = 0;
  std::size_t dropped = 0;  // number of texts dropped since the last one that was written
  bool writes = false;      // the thread is in write()
  bool has_thread = false, ends = false;
};

TextOutput::TextOutput(int out, int err) : out_(out), err_(err), state_(std::make_shared<State>()) {
  try {
    std::thread(work, state_).detach();
    state_->has_thread = true;
  } catch (const std::system_error&) {  // no thread can be started: the texts are lost
  }
}

TextOutput::~TextOutput() {
  if (has_reader_) static_cast<void>(finish(kPatience));
  const std::scoped_lock lock(state_->mutex);
  state_->ends = true;
  state_->changed.notify_all();
}

void TextOutput::print(std::string text) { add(out_, std::move(text)); }

void TextOutput::print_error(std::string text) { add(err_, std::move(text)); }

void TextOutput::add(int descriptor, std::string text) {
  try {
    const std::scoped_lock lock(state_->mutex);
    state_->waiting_bytes += text.size();
    state_->waiting.push_back({descriptor, std::move(text)});
    while (state_->waiting_bytes > kMaxWaitingBytes && state_->waiting.size() > 1) {
      state_->waiting_bytes -= state_->waiting.front().text.size();
      state_->waiting.pop_front();
      ++state_->dropped;
    }
    state_->changed.notify_all();
  } catch (const std::bad_alloc&) {
  }
}

bool TextOutput::finish(std::chrono::milliseconds at_most) {
  std::unique_lock lock(state_->mutex);
  has_reader_ = state_->changed.wait_for(
      lock, at_most, [this] { return !state_->has_thread || (state_->waiting.empty() && !state_->writes); });
  return has_reader_;
}

void TextOutput::work(const std::shared_ptr<State>& state) {
  std::unique_lock lock(state->mutex);
  for (;;) {
    state->changed.wait(lock, [&] { return state->ends || !state->waiting.empty(); });
    if (state->waiting.empty()) return;
    State::WaitingText next = std::move(state->waiting.front());
    state->waiting.pop_front();
    state->waiting_bytes -= next.text.size();
    const std::size_t dropped = std::exchange(state->dropped, 0);
    state->writes = true;
    lock.unlock();
    if (dropped > 0) {
      write_text(next.descriptor, std::to_string(dropped) + " messages were dropped because nobody read them\n");
    }
    write_text(next.descriptor, next.text);
    lock.lock();
    state->writes = false;
    state->changed.notify_all();
  }
}

}  // namespace touchline::hal
