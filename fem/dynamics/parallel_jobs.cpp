#include "fem/dynamics/parallel_jobs.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <system_error>
#include <thread>

#include "geometry/base.h"

namespace flexmorph::fem {
namespace {

/// The threads that run a list of jobs.
class Crew {
 public:
  explicit Crew(const std::vector<Job>& jobs)
      : jobs_(jobs), order_(jobs.size()), failures_(jobs.size()), failed_(jobs.size()) {
    std::iota(order_.begin(), order_.end(), size_t{0});
  }

  void work(int threads) {
    const size_t n = std::min(static_cast<size_t>(std::max(threads, 1)), jobs_.size());
    if (n <= 1) {
      work_off();
    } else {
      std::stable_sort(order_.begin(), order_.end(),
                       [&](size_t a, size_t b) { return jobs_[a].cost > jobs_[b].cost; });
      std::vector<std::thread> others;
      try {
        for (size_t k = 0; k < n; ++k)
          others.emplace_back([this] {
            omp_set_num_threads(1);  // for this thread only
            work_off();
          });
      } catch (const std::system_error&) {
        // No further thread can be started: the started threads run all jobs, or this thread does.
        if (others.empty()) work_off();
      }
      for (std::thread& other : others) other.join();
    }
    for (const std::exception_ptr& failure : failures_)
      if (failure) std::rethrow_exception(failure);
  }

 private:
  void work_off() {
    for (size_t next = taken_++; next < jobs_.size(); next = taken_++) {
      const size_t i = order_[next];
      if (failed_ < i) continue;
      try {
        do_one(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        failures_[i] = std::current_exception();
        failed_ = std::min(failed_.load(), i);
      }
    }
  }

  void do_one(size_t i) {
    try {
      jobs_[i].run([this, i] { return failed_ >= i; });
    } catch (const Error& error) {
      throw Error(error.kind(), jobs_[i].name + ": " + error.what());
    }
  }

  const std::vector<Job>& jobs_;
  std::vector<size_t> order_;  // order in which the jobs are started
  std::vector<std::exception_ptr> failures_;
  std::atomic<size_t> taken_ = 0;
  std::atomic<size_t> failed_;  // index of the first job that failed; number of jobs: none
  std::mutex mutex_;
};

}  // namespace

void side_by_side(int threads, const std::vector<Job>& jobs) { Crew(jobs).work(threads); }

}  // namespace flexmorph::fem
