#include "io/background.h"

#include <system_error>
#include <utility>

namespace flexmorph::io {

Background::Background(bool own_thread) {
  if (!own_thread) return;
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error&) {  // no thread is available: tasks are executed at once
  }
}

Background::~Background() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Background::rethrow() {
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Background::then(std::function<void()> task) {
  if (!thread_.joinable()) return task();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return tasks_.size() < kMaxWaitingJobs || failure_; });
  rethrow();
  tasks_.push_back(std::move(task));
  changed_.notify_all();
}

void Background::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return tasks_.empty(); });
  rethrow();
}

void Background::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return !tasks_.empty() || ends_; });
    if (tasks_.empty()) return;
    // references into a deque stay valid when tasks are added
    const std::function<void()>& task = tasks_.front();
    lock.unlock();
    std::exception_ptr failure;
    try {
      task();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    if (failure) tasks_.resize(1);  // the tasks after the one that failed are dropped
    tasks_.pop_front();
    changed_.notify_all();
  }
}

}  // namespace flexmorph::io
