#include "fem/solve/factorization/grid_order.h"

#include <cstddef>

namespace flexmorph::fem {

namespace {

// Number of nodes of a rectangle that is not halved any more. Blocks of the factor join more nodes.
constexpr int kMinBlock = 4;

struct Dissection {
  const Grid& grid;
  std::vector<int> order;

  /// Orders the nodes [i, i_end) x [j, j_end).
  void order_rectangle(int i, int i_end, int j, int j_end) {
    const int wide = i_end - i, high = j_end - j;
    if (wide * high <= kMinBlock || (wide < 3 && high < 3)) {
      append(i, i_end, j, j_end);
    } else if (wide >= high) {
      const int middle = i + wide / 2;
      order_rectangle(i, middle, j, j_end);
      order_rectangle(middle + 1, i_end, j, j_end);
      append(middle, middle + 1, j, j_end);
    } else {
      const int middle = j + high / 2;
      order_rectangle(i, i_end, j, middle);
      order_rectangle(i, i_end, middle + 1, j_end);
      append(i, i_end, middle, middle + 1);
    }
  }
  void append(int i, int i_end, int j_begin, int j_end) {
    for (; i < i_end; ++i)
      for (int j = j_begin; j < j_end; ++j) order.push_back(grid.node(i, j));
  }
};

}  // namespace

std::vector<int> dissection_order(const Grid& grid) {
  Dissection d{grid, {}};
  d.order.reserve(static_cast<std::size_t>(grid.n_nodes()));
  d.order_rectangle(0, grid.nx + 1, 0, grid.ny + 1);
  return d.order;
}

}  // namespace flexmorph::fem
