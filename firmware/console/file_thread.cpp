#include "firmware/console/file_thread.h"

#include <sys/resource.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Time to wait for a running job at the end of the program. Reading some small files takes milliseconds; a job that
// takes longer is abandoned.
constexpr auto kEndPatience = 200ms;

}  // namespace

struct FileThread::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Job> jobs;
  std::vector<Finish> finished;
  bool runs = false, ends = false;
};

FileThread::FileThread(Priority priority) : priority_(priority), shared_(std::make_shared<Shared>()) {}

FileThread::~FileThread() {
  std::unique_lock lock(shared_->mutex);
  shared_->ends = true;
  shared_->jobs.clear();
  shared_->changed.notify_all();
  shared_->changed.wait_for(lock, kEndPatience, [this] { return !shared_->runs; });
}

void FileThread::run(Job job) {
  const std::scoped_lock lock(shared_->mutex);
  shared_->jobs.push_back(std::move(job));
  shared_->changed.notify_all();
  if (shared_->runs) return;
  std::thread([shared = shared_, priority = priority_] { work(shared, priority); }).detach();
  shared_->runs = true;
}

void FileThread::work(const std::shared_ptr<Shared>& shared, Priority priority) {
  // On Linux, this sets the priority of this thread only. If the system refuses this, the job may slow down other
  // threads.
  if (priority == Priority::kLowest) static_cast<void>(::setpriority(PRIO_PROCESS, 0, kLowestNice));
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->changed.wait(lock, [&] { return shared->ends || !shared->jobs.empty(); });
    if (shared->ends) break;
    Job job = std::move(shared->jobs.front());
    shared->jobs.pop_front();
    lock.unlock();
    Finish finish = job();
    job = nullptr;
    lock.lock();
    shared->finished.push_back(std::move(finish));
  }
  shared->runs = false;
  shared->changed.notify_all();
}

void FileThread::finish() {
  std::vector<Finish> finished;
  {
    const std::scoped_lock lock(shared_->mutex);
    finished.swap(shared_->finished);
  }
  for (const Finish& finish : finished) {
    if (finish) finish();
  }
}

}  // namespace touchline::console
