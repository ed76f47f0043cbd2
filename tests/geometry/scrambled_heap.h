#pragma once

#include <memory>
#include <random>
#include <vector>

/// A heap in another state: later allocations have other addresses in another order.
namespace flexmorph::test {

class ScrambledHeap {
 public:
  explicit ScrambledHeap(unsigned seed) : engine_(seed), blocks_(4000) {}

  /// Allocates and frees blocks of 16 B to 40 kB, so that free areas of all sizes are in any order.
  void again() {
    for (int k = 0; k < 3000; ++k) {
      std::unique_ptr<char[]>& block = blocks_[engine_() % blocks_.size()];
      const bool taken = engine_() % 3 != 0;
      block.reset(taken ? new char[16 + engine_() % 40000] : nullptr);
    }
  }

 private:
  std::mt19937 engine_;
  std::vector<std::unique_ptr<char[]>> blocks_;
};

}  // namespace flexmorph::test
