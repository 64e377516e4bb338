#include "qnv/codecs/values/encode/error_meter.h"

#include "qnv/codecs/values/encode/encode_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

namespace gs::qnv::values {

namespace {

/// Sum of errors. The sums of slices are added in order, so that the result does not depend on threads.
struct ErrorSum {
  std::int64_t most = 0;
  double squares = 0;
  std::uint64_t count = 0;

  void add(const ErrorSum& other) {
    most = std::max(most, other.most);
    squares += other.squares;
    count += other.count;
  }
};

// Samples of a slice, and those that were decoded.
struct ComparedSlice {
  std::span<const std::int32_t> truth, decoded;
  std::span<const std::uint8_t> missing;  // empty if none is
};

// Returns the error of samples if none is missing. Uses four independent sums, each of every fourth sample.
ErrorSum error_of_all(const ComparedSlice& slice) {
  constexpr std::size_t kSums = 4;
  std::array<double, kSums> squares{};
  std::array<std::int32_t, kSums> most{}, least{};
  const std::int32_t *const truth = slice.truth.data(), *const decoded = slice.decoded.data();
  std::size_t i = 0;
  const auto add = [&](std::size_t k, std::int32_t apart) {
    most.data()[k] = std::max(most.data()[k], apart);
    least.data()[k] = std::min(least.data()[k], apart);
    squares.data()[k] += static_cast<double>(apart) * apart;
  };
  for (; i + kSums <= slice.truth.size(); i += kSums)
    for (std::size_t k = 0; k < kSums; ++k) add(k, truth[i + k] - decoded[i + k]);
  for (; i < slice.truth.size(); ++i) add(0, truth[i] - decoded[i]);
  ErrorSum sum;
  sum.count = slice.truth.size();
  sum.most = std::max<std::int64_t>(*std::ranges::max_element(most), -std::int64_t{*std::ranges::min_element(least)});
  sum.squares = (squares[0] + squares[1]) + (squares[2] + squares[3]);
  return sum;
}

ErrorSum error_of(const ComparedSlice& slice) {
  if (slice.missing.empty()) return error_of_all(slice);
  ErrorSum sum;
  sum.count = slice.truth.size();
  double squares = 0;
  std::int32_t most = 0, least = 0;
  for (std::size_t i = 0; i < slice.truth.size(); ++i) {
    const bool there = slice.missing[i] == 0;
    const std::int32_t apart = there ? slice.truth[i] - slice.decoded[i] : 0;
    most = std::max(most, apart);
    least = std::min(least, apart);
    squares += static_cast<double>(apart) * apart;
    if (!there) --sum.count;
  }
  sum.most = std::max<std::int64_t>(most, -std::int64_t{least});
  sum.squares = squares;
  return sum;
}

// Finds the corrections of a slice. Returns the error after them.
ErrorSum correct(const ComparedSlice& slice, std::uint32_t most_error, std::span<std::uint32_t> corrections) {
  ErrorSum sum;
  const std::int64_t step = correction_step(most_error), most = most_error;
  for (std::size_t i = 0; i < slice.truth.size(); ++i) {
    corrections[i] = 0;
    if (!slice.missing.empty() && slice.missing[i] != 0) continue;
    std::int64_t apart = std::int64_t{slice.truth[i]} - slice.decoded[i];
    if (apart < -most || apart > most) {
      const std::int64_t steps = (apart >= 0 ? apart + most : apart - most) / step;
      corrections[i] = static_cast<std::uint32_t>(steps);
      apart -= steps * step;
    }
    sum.most = std::max(sum.most, std::abs(apart));
    sum.squares += static_cast<double>(apart * apart);
    ++sum.count;
  }
  return sum;
}

}  // namespace

std::variant<ValueError, EncodeError> ErrorMeter::measure(const SliceRestorer::WriteBlock& write,
                                                          std::uint32_t most_error, RemainderEncoder* corrections) {
  if (progress_) {
    progress_->stage = "measuring";
    progress_->done = 0;
    progress_->total = extent_[2];
  }
  SliceRestorer restorer(extent_, threads_, write);
  const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
  SampleBatch batch;
  std::vector<std::int32_t> decoded;
  std::vector<std::uint32_t> steps;
  ErrorSum whole;
  for (std::uint32_t z = 0; z < extent_[2]; z += kBatchSlices) {
    if (is_cancelled(progress_)) return EncodeError{"cancelled"};
    if (auto problem = read_(z, std::min(kBatchSlices, extent_[2] - z), batch)) return std::move(*problem);
    decoded.resize(slice * batch.count);
    steps.resize(corrections ? slice * batch.count : 0);
    std::vector<SliceRows> slices;
    for (std::uint32_t i = 0; i < batch.count; ++i) slices.push_back({decoded.data() + i * slice, extent_[0]});
    restorer.next(slices);
    std::vector<ErrorSum> sums(batch.count);
    (void)parallel_for(
        batch.count,
        [&](std::size_t i) {
          const std::size_t at = i * slice;
          ComparedSlice compared{
              std::span(batch.samples).subspan(at, slice), std::span(decoded).subspan(at, slice), {}};
          if (!batch.missing.empty()) compared.missing = std::span(batch.missing).subspan(at, slice);
          sums[i] =
              corrections ? correct(compared, most_error, std::span(steps).subspan(at, slice)) : error_of(compared);
        },
        threads_for(slice * batch.count, threads_));
    for (const ErrorSum& sum : sums) whole.add(sum);
    if (corrections)
      for (std::size_t at = 0; at < steps.size(); at += kCubeEdge * slice)
        corrections->add(std::span(steps).subspan(at, std::min(kCubeEdge * slice, steps.size() - at)));
    if (progress_) progress_->done = z + batch.count;
  }
  if (corrections) corrections->finish();
  const double mean = whole.count > 0 ? whole.squares / static_cast<double>(whole.count) : 0;
  return ValueError{0, static_cast<float>(whole.most), static_cast<float>(std::sqrt(mean))};
}

}  // namespace gs::qnv::values
