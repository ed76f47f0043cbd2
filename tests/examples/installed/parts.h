#pragma once

#include "fem/terms.h"
#include "optim/mmc/problem/response.h"
#include "optim/optimizer.h"

/// The parts that the example adds, which stand in the files beside it.
namespace flexmorph {
namespace fem {
const TermRow& cords_row();  ///< term.cpp
}
namespace mmc {
extern const ResponseRow kFirstMoment;  ///< response.cpp
}
namespace optim {
std::unique_ptr<Optimizer> make_steepest_descent(const Settings& settings);  ///< optimizer.cpp
}
}  // namespace flexmorph
