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

// Samples of a slice, and those that were decoded.
struct ComparedSlice {
  std::span<const std::int32_t> truth, decoded;
  std::span<const std::uint8_t> missing;  // empty if none is
};

// Returns the error of all samples that are not missing.
ErrorSum error_of(const ComparedSlice& slice) {
  // Adds small squares in blocks so short that their sums fit into 64 bits.
  constexpr std::size_t kRun = 4096;
  constexpr std::int64_t kSmall = std::int64_t{1} << 25;
  ErrorSum sum;
  sum.count = slice.truth.size();
  const std::int32_t *const truth = slice.truth.data(), *const decoded = slice.decoded.data();
  for (std::size_t at = 0; at < slice.truth.size(); at += kRun) {
    const std::size_t end = std::min(at + kRun, slice.truth.size());
    std::uint64_t squares = 0;
    std::int64_t most = 0, least = 0;
    const auto add = [&](std::size_t i, bool there) {
      const std::int64_t apart = there ? std::int64_t{truth[i]} - decoded[i] : 0;
      most = std::max(most, apart);
      least = std::min(least, apart);
      squares += static_cast<std::uint64_t>(apart * apart);
    };
    if (slice.missing.empty())
      for (std::size_t i = at; i < end; ++i) add(i, true);
    else
      for (std::size_t i = at; i < end; ++i) {
        const bool there = slice.missing[i] == 0;
        add(i, there);
        if (!there) --sum.count;
      }
    sum.most = std::max({sum.most, most, -least});
    if (std::max(most, -least) < kSmall) {
      sum.squares.add(squares);
      continue;
    }
    for (std::size_t i = at; i < end; ++i)
      if (slice.missing.empty() || slice.missing[i] == 0) {
        const std::int64_t apart = std::int64_t{truth[i]} - decoded[i];
        sum.squares.add(static_cast<std::uint64_t>(apart * apart));
      }
  }
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
    sum.squares.add(static_cast<std::uint64_t>(apart * apart));
    ++sum.count;
  }
  return sum;
}

}  // namespace

std::optional<EncodeError> ErrorMeter::add_errors(const SliceRestorer::WriteBlock& write, std::uint32_t most_error,
                                                  RemainderEncoder* corrections, ErrorSum& whole) {
  const SliceWindow window = slices_of(slabs_of(ranks_, extent_[2]), extent_[2]);
  if (progress_) {
    progress_->stage = "measuring";
    progress_->done = 0;
    progress_->total = window.end - window.first;
  }
  if (window.first == window.end) return std::nullopt;
  SliceRestorer restorer(extent_, threads_, write, window);
  const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
  SampleBatch batch;
  std::vector<std::int32_t> decoded;
  std::vector<std::uint32_t> steps;
  for (std::uint32_t z = window.first; z < window.end; z += kBatchSlices) {
    if (is_cancelled(progress_)) return EncodeError{"cancelled"};
    if (auto problem = read_(z, std::min(kBatchSlices, window.end - z), batch)) return problem;
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
    if (progress_) progress_->done += batch.count;
  }
  if (corrections) corrections->finish();
  return std::nullopt;
}

std::variant<ValueError, EncodeError> ErrorMeter::measure(const SliceRestorer::WriteBlock& write,
                                                          std::uint32_t most_error, RemainderEncoder* corrections) {
  ErrorSum own;
  if (auto problem = agree(ranks_, add_errors(write, most_error, corrections, own))) return std::move(*problem);
  ErrorSum whole;
  for (const ErrorSum& part : gather_records(ranks_, std::span<const ErrorSum>(&own, 1))) whole.add(part);
  const double mean = whole.count > 0 ? whole.squares.value() / static_cast<double>(whole.count) : 0;
  return ValueError{0, static_cast<float>(whole.most), static_cast<float>(std::sqrt(mean))};
}

}  // namespace gs::qnv::values
