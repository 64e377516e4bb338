#include "render/gaussians/gaussian_levels.h"

#include "base/parallel.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

// Limits of the levels of one file: bytes of decoded clusters, bytes for cuts, and number of Gaussians.
constexpr qnv::SplatLimits kLevelLimits{std::size_t{1} << 27, std::size_t{1} << 28, GaussianLevels::kMost};
// Maximum number of Gaussians of a view that moves without a budget. Two cores draw about 8 M per second.
constexpr std::size_t kMostMoving = 400'000;
// Maximum seconds from the end of a motion until all Gaussians replace the cut. Longer than the fades of the cut.
constexpr double kSettling = 0.28;
// Interval between checks while a thread waits until the Gaussians are steady.
constexpr std::chrono::milliseconds kSteadyStep{50};

/// Approximate bytes of the stream for one Gaussian, and for one coefficient of harmonics.
constexpr std::size_t kStreamBytes = 12, kHarmonicStreamBytes = 1;

/// Returns the maximum bytes that the levels of Gaussians keep in memory.
std::size_t bytes_of_levels(const qnv::Gaussians& gaussians) {
  const std::size_t decoded = gaussians.size() * qnv::bytes_of_splat(gaussians.degree),
                    stream = gaussians.size() *
                             (kStreamBytes + kHarmonicStreamBytes * qnv::harmonic_count(gaussians.degree));
  return stream + std::min(decoded, kLevelLimits.cache_bytes) + std::min(decoded, kLevelLimits.cut_bytes);
}

/// Encodes Gaussians and decodes the part that a view needs. Returns null if it is cancelled or impossible.
std::unique_ptr<qnv::SplatStream> encoded_levels(const qnv::Gaussians& gaussians, const qnv::LodView& view,
                                                 Progress& progress) {
  qnv::EncodeOptions options;
  options.threads = 1;     // other threads draw
  options.fitted = false;  // moving views gain little from it
  auto encoded = qnv::encode_gaussians(gaussians, options, &progress);
  const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream || is_cancelled(&progress)) return nullptr;
  auto opened = qnv::SplatStream::open(stream->bytes);
  auto* made = std::get_if<std::unique_ptr<qnv::SplatStream>>(&opened);
  if (!made) return nullptr;
  (*made)->set_limits(kLevelLimits);
  (void)(*made)->cut(view);
  return std::move(*made);
}

}  // namespace

/// Work of a thread.
struct GaussianLevels::Work {
  Progress progress;
  Share share;                      // of the budget of the world
  std::atomic<bool> moves = false;  // a view moves, so the thread does not wait until the Gaussians are steady
  std::atomic<bool> done = false;
  std::unique_ptr<qnv::SplatStream> stream;  // valid if `done`; null if there are no levels
};

GaussianLevels::~GaussianLevels() {
  for (auto& [gaussians, entry] : entries_)
    if (entry.work) entry.work->progress.cancelled = true;
}

bool GaussianLevels::working() const {
  return std::ranges::any_of(entries_, [](const auto& one) { return one.second.work && !one.second.work->done; });
}

void GaussianLevels::forget_unused() {
  std::erase_if(entries_, [&](const auto& one) {
    const std::shared_ptr<Work>& work = one.second.work;
    const bool runs = work && !work->done;  // then the thread is one of the owners
    if (one.first.use_count() > (runs ? 1 : 0)) return false;
    if (runs) {
      work->progress.cancelled = true;
      changing_ = true;
    }
    return true;
  });
}

void GaussianLevels::start(const std::shared_ptr<const qnv::Gaussians>& gaussians, const GaussianMotion& motion,
                           Entry& entry) {
  auto work = std::make_shared<Work>();
  work->share = Share(motion.budget, Resource::vectors);
  work->moves = motion.coarseness > 1;
  if (!work->share.grow(bytes_of_levels(*gaussians))) return;  // later pictures try again
  qnv::LodView view = motion.view;
  view.error_pixels /= std::max(motion.coarseness, 1.0f);
  view.budget = 0;
  view.most_decoded = 0;
  const std::chrono::milliseconds steady = changing_ ? steady_ : std::chrono::milliseconds(0);
  // The thread owns its data. No code waits for it, even at the end of the program.
  try {
    std::thread([work, gaussians, view, steady] {
      const auto end = std::chrono::steady_clock::now() + steady;
      while (!work->moves && !is_cancelled(&work->progress) && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(kSteadyStep);
      try {
        if (!is_cancelled(&work->progress)) work->stream = encoded_levels(*gaussians, view, work->progress);
      } catch (const std::exception&) {
        work->stream = nullptr;  // memory does not suffice
      }
      if (!work->stream) work->share = {};
      work->done = true;
    }).detach();
  } catch (const std::exception&) {
    work->share = {};
    work->done = true;  // the system allows no more threads
  }
  entry.work = std::move(work);
}

const std::vector<qnv::SplatRun>* GaussianLevels::cut(const std::shared_ptr<const qnv::Gaussians>& gaussians,
                                                      const GaussianMotion& motion, bool eager, bool& pending) {
  if (!gaussians || gaussians->size() < least_ || gaussians->size() > kMost) return nullptr;
  Entry& entry = entries_[gaussians];
  const bool moves = motion.coarseness > 1;
  qnv::LodView fine = motion.view, wanted = motion.view;
  fine.error_pixels /= std::max(motion.coarseness, 1.0f);
  fine.budget = 0;
  wanted.budget = !moves ? 0 : wanted.budget == 0 ? kMostMoving : wanted.budget;
  if (!entry.work && (moves || eager) && !working()) start(gaussians, motion, entry);
  if (entry.work && moves) entry.work->moves = true;
  if (entry.work && entry.work->done && entry.work->stream) changing_ = false;
  if (!entry.work || !entry.work->done || !entry.work->stream) return nullptr;
  qnv::SplatStream& stream = *entry.work->stream;
  if (!entry.shown.contains(motion.view.viewport)) {
    if (!moves) return nullptr;
    // The first cut is as fine as the Gaussians that it replaces, unless the cache has freed a part of it. Coarser ones
    // then fade in. Drawing all Gaussians until the cut is decoded would make the start of the motion slow.
    stream.forget(motion.view.viewport);
    (void)stream.cut(fine, motion.time);
    entry.shown[motion.view.viewport].moves = true;
  }
  if (!moves && !motion.fades) {
    entry.shown.erase(motion.view.viewport);
    return nullptr;
  }
  Shown& shown = entry.shown[motion.view.viewport];
  if (shown.moves && !moves) shown.rests_since = motion.time;
  shown.moves = moves;
  const std::vector<qnv::SplatRun>& runs = stream.cut(wanted, motion.time, motion.fades);
  const bool changes = stream.fading() || stream.pending();
  if (!moves && (!changes || motion.time - shown.rests_since > kSettling)) {
    entry.shown.erase(motion.view.viewport);
    return nullptr;
  }
  pending = pending || changes;
  return &runs;
}

}  // namespace gs::render
