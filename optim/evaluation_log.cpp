#include "optim/evaluation_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

namespace flexmorph::optim {
namespace {

const std::string kHead = "flexmorph evaluations 4\n";
constexpr std::uint64_t kMaxRecordBytes = 1ULL << 32;  // largest plausible record [bytes]
constexpr auto kSyncEvery = std::chrono::seconds(5);

struct RecordHead {
  std::uint64_t bytes = 0;
  std::uint64_t crc = 0;
};

std::uint64_t crc_of(const std::vector<char>& data) {
  boost::crc_32_type crc;
  crc.process_bytes(data.data(), data.size());
  return crc.checksum();
}

void put(std::vector<char>& out, const void* data, size_t bytes) {
  const auto* begin = static_cast<const char*>(data);
  out.insert(out.end(), begin, begin + bytes);
}
void put(std::vector<char>& out, std::int64_t number) { put(out, &number, sizeof number); }
template <class Derived>
void put(std::vector<char>& out, const Eigen::PlainObjectBase<Derived>& v) {
  put(out, static_cast<std::int64_t>(v.rows()));
  put(out, static_cast<std::int64_t>(v.cols()));
  put(out, v.data(), sizeof(double) * static_cast<size_t>(v.size()));
}

/// Reads data that put() has written; take() returns false beyond the end of the data.
class Reader {
 public:
  explicit Reader(const std::vector<char>& data) : data_(data) {}
  bool take(void* out, size_t bytes) {
    if (bytes > data_.size() - at_) return false;
    std::copy_n(data_.data() + at_, bytes, static_cast<char*>(out));
    at_ += bytes;
    return true;
  }
  bool take(std::int64_t& out) { return take(&out, sizeof out); }
  template <class Derived>
  bool take(Eigen::PlainObjectBase<Derived>& out) {
    std::int64_t rows = 0, columns = 0;
    const auto most = static_cast<std::int64_t>(data_.size() / sizeof(double));
    if (!take(rows) || !take(columns) || rows < 0 || columns < 0 || rows > most || columns > most)
      return false;
    if (rows * columns > most) return false;
    out.resize(rows, columns);
    return take(out.data(), sizeof(double) * static_cast<size_t>(out.size()));
  }

 private:
  const std::vector<char>& data_;
  size_t at_ = 0;
};

std::vector<char> packed(const Evaluation& e) {
  std::vector<char> out;
  put(out, e.x);
  put(out, static_cast<std::int64_t>(e.failure.size()));
  put(out, e.failure.data(), e.failure.size());
  put(out, static_cast<std::int64_t>(e.acceptable));
  put(out, &e.response.f, sizeof e.response.f);
  put(out, e.response.df);
  put(out, e.response.g);
  put(out, e.response.dg);
  put(out, &e.response.first_bound, sizeof e.response.first_bound);
  put(out, &e.response.n_bounds, sizeof e.response.n_bounds);
  put(out, static_cast<std::int64_t>(e.work.size()));
  put(out, e.work.data(), sizeof(std::uint64_t) * e.work.size());
  return out;
}

std::optional<Evaluation> unpacked(const std::vector<char>& data) {
  Evaluation e;
  Reader in(data);
  std::int64_t letters = 0, acceptable = 0, counters = 0;
  if (!in.take(e.x) || !in.take(letters) || letters < 0 ||
      letters > static_cast<std::int64_t>(data.size()))
    return {};
  e.failure.resize(static_cast<size_t>(letters));
  if (!in.take(e.failure.data(), e.failure.size()) || !in.take(acceptable) ||
      !in.take(&e.response.f, sizeof e.response.f) || !in.take(e.response.df) ||
      !in.take(e.response.g) || !in.take(e.response.dg) ||
      !in.take(&e.response.first_bound, sizeof e.response.first_bound) ||
      !in.take(&e.response.n_bounds, sizeof e.response.n_bounds) || !in.take(counters) ||
      counters < 0 || counters > static_cast<std::int64_t>(data.size() / sizeof(std::uint64_t)))
    return {};
  e.work.resize(static_cast<size_t>(counters));
  if (!in.take(e.work.data(), sizeof(std::uint64_t) * e.work.size())) return {};
  e.acceptable = acceptable != 0;
  return e;
}

bool read_whole(int file, void* out, size_t bytes, std::int64_t at) {
  return pread(file, out, bytes, at) == static_cast<ssize_t>(bytes);
}

/// Tells whether two vectors agree bit for bit; equal NaN entries agree as well.
bool same(const VectorXd& a, const VectorXd& b) {
  return a.size() == b.size() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<size_t>(a.size())) == 0);
}

bool is_finite(const ProblemValues& r) {
  return std::isfinite(r.f) && r.df.allFinite() && r.g.allFinite() && r.dg.allFinite();
}

}  // namespace

EvaluationLog::EvaluationLog(std::string path) : path_(std::move(path)) {
  file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  std::string head(kHead.size(), ' ');
  if (file_ >= 0 && read_whole(file_, head.data(), head.size(), 0) && head == kHead) {
    end_ = static_cast<std::int64_t>(kHead.size());
    return;
  }
  reading_ = false;
  if (file_ < 0 || ftruncate(file_, 0) != 0 ||
      pwrite(file_, kHead.data(), kHead.size(), 0) != static_cast<ssize_t>(kHead.size()))
    throw Error::numerical(path_ +
                           ": cannot be written: " + std::generic_category().message(errno));
  end_ = static_cast<std::int64_t>(kHead.size());
}

EvaluationLog::~EvaluationLog() { close(file_); }

void EvaluationLog::drop_rest() {
  reading_ = false;
  if (ftruncate(file_, end_) != 0)
    throw Error::numerical(path_ +
                           ": cannot be written: " + std::generic_category().message(errno));
}

/// Reads the record that begins at a position.
/// @param end  position of the record; on return that of the next record, or unchanged if there is
///             no complete record
std::optional<Evaluation> EvaluationLog::read(std::int64_t& end) const {
  RecordHead head;
  if (!read_whole(file_, &head, sizeof head, end) || head.bytes >= kMaxRecordBytes) return {};
  std::vector<char> data(head.bytes);
  const auto at = end + static_cast<std::int64_t>(sizeof head);
  if (!read_whole(file_, data.data(), data.size(), at) || crc_of(data) != head.crc) return {};
  std::optional<Evaluation> out = unpacked(data);
  if (out) end = at + static_cast<std::int64_t>(head.bytes);
  return out;
}

std::optional<Evaluation> EvaluationLog::next(const VectorXd& x) {
  knew_last_ = false;
  work_after_.clear();
  if (!reading_) return {};
  std::int64_t end = end_;
  std::optional<Evaluation> found = read(end);
  if (!found || !same(found->x, x)) {
    drop_rest();
    return {};
  }
  end_ = end;
  if (std::optional<Evaluation> after = read(end); after && after->x.size() == 0) {
    work_after_ = std::move(after->work);
    end_ = end;
  }
  knew_last_ = true;
  ++n_known_;
  return found;
}

void EvaluationLog::append_work(const Work& work) {
  std::int64_t end = end_;
  if (reading_ && read(end)) return;
  if (reading_) drop_rest();
  Evaluation record;
  record.work = work;
  append(record);
}

void EvaluationLog::append(const Evaluation& evaluation) {
  const std::vector<char> data = packed(evaluation);
  const RecordHead head{data.size(), crc_of(data)};
  std::vector<char> record;
  put(record, &head, sizeof head);
  put(record, data.data(), data.size());
  if (pwrite(file_, record.data(), record.size(), end_) != static_cast<ssize_t>(record.size()))
    throw Error::numerical(path_ +
                           ": cannot be written: " + std::generic_category().message(errno));
  end_ += static_cast<std::int64_t>(record.size());
  const auto now = std::chrono::steady_clock::now();
  if (now - synced_ < kSyncEvery) return;
  fdatasync(file_);  // a power failure loses the last seconds, a killed process loses nothing
  synced_ = now;
}

ProblemValues RecordedProblem::evaluate(const VectorXd& x) {
  if (std::optional<Evaluation> known = log_.next(x)) {
    acceptable_ = known->acceptable;
    if (counter_) counter_->continue_from(known->work);
    if (!known->failure.empty()) throw Error::numerical(known->failure);
    return std::move(known->response);
  }
  Evaluation now;
  now.x = x;
  try {
    now.response = problem_.evaluate(x);
    if (is_finite(now.response)) now.acceptable = problem_.acceptable(x);
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    now.failure = error.what();
  }
  acceptable_ = now.acceptable;
  if (counter_) now.work = counter_->work();
  log_.append(now);
  if (!now.failure.empty()) throw Error::numerical(now.failure);
  return std::move(now.response);
}

bool RecordedProblem::acceptable(const VectorXd&) { return acceptable_; }

}  // namespace flexmorph::optim
