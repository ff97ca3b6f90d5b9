#include "firmware/console/answer_worker.h"

#include <exception>
#include <memory>
#include <utility>

namespace touchline::console {

void AnswerWorker::start(std::function<MadeAnswer()> make) {
  is_busy_ = true;
  is_done_ = false;
  thread_.run([this, make = std::move(make)]() -> FileThread::Finish {
    auto answer = std::make_shared<MadeAnswer>();
    try {
      *answer = make();
    } catch (const std::exception&) {  // memory is short
      *answer = {};
    }
    return [this, answer] {
      answer_ = std::move(*answer);
      is_done_ = true;
    };
  });
}

bool AnswerWorker::is_done() {
  thread_.finish();
  return is_done_;
}

MadeAnswer AnswerWorker::take() {
  is_busy_ = is_done_ = false;
  return std::exchange(answer_, {});
}

}  // namespace touchline::console
