#include "cases/results/failure.h"

namespace flexmorph::cases {

Failure failure_of(const std::exception& error, const Failure& here) {
  Failure out = here;
  if (const auto* stopped = dynamic_cast<const FailedRun*>(&error)) out = stopped->where();
  const auto* known = dynamic_cast<const Error*>(&error);
  out.kind = !known ? "defect" : known->kind() == Error::Kind::input ? "input" : "numerical";
  out.cause = error.what();
  return out;
}

}  // namespace flexmorph::cases
