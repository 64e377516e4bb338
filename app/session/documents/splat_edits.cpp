#include "app/session/documents/splat_edits.h"

#include "app/formats/qnv/geometry_reader.h"
#include "app/session/documents/documents.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostRanked = 200'000;  // maximum number of splats for percentiles
constexpr double kCropMargin = 0.15;          // share of a side, so that feet and hair stay inside

SplatExtent extent_of_splats(const qnv::Gaussians& splats) {
  SplatExtent extent;
  const glm::dvec3& origin = splats.description.origin;
  for (const glm::vec3& scales : splats.scales)
    extent.largest = std::max({extent.largest, scales.x, scales.y, scales.z});
  for (const glm::vec3& position : splats.positions) extent.whole.add(origin + glm::dvec3(position));
  if (splats.empty()) return extent;
  glm::dvec3 low(0), high(0);
  const std::size_t step = splats.size() / kMostRanked + 1;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (std::size_t i = 0; i < splats.size(); i += step) values.push_back(splats.positions[i][axis]);
    const auto at = [&](double share) {
      const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + rank, values.end());
      return double{values[static_cast<std::size_t>(rank)]};
    };
    low[axis] = at(0.01);
    high[axis] = at(0.99);
  }
  const glm::dvec3 margin = (high - low) * kCropMargin;
  extent.middle.add(glm::max(origin + low - margin, extent.whole.lower));
  extent.middle.add(glm::min(origin + high + margin, extent.whole.upper));
  return extent;
}

}  // namespace

std::optional<OnlySplats> only_splats(const LoadedWorld& world) {
  if (world.authored || !world.scene || world.geometries.size() != 1) return std::nullopt;
  const auto& [node, geometry] = *world.geometries.begin();
  if (!geometry || !geometry->as<qnv::Gaussians>()) return std::nullopt;
  const auto& nodes = world.scene->nodes();
  for (std::uint32_t i = 1; i <= nodes.count(); ++i)
    if (&nodes.at(i) == node) {
      OnlySplats found;
      found.place.scene = world.scene.get();
      found.place.node = nodes.id_at(i);
      found.geometry = geometry;
      return found;
    }
  return std::nullopt;
}

void SplatEdits::set(const SplatEdit& edit, double time, std::uint64_t gesture) {
  if (edit == edit_) return;
  undone_.clear();
  if (gesture != 0 && !done_.empty() && done_.back().gesture == gesture) {
    done_.back().after = edit;
    done_.back().time = time;
  } else {
    if (done_.size() >= kMostUndone) done_.erase(done_.begin());
    done_.push_back({edit_, edit, time, gesture});
  }
  edit_ = edit;
}

void SplatEdits::go(int direction) {
  std::vector<Change>&from = direction < 0 ? done_ : undone_, &to = direction < 0 ? undone_ : done_;
  if (from.empty()) return;
  to.push_back(std::move(from.back()));
  from.pop_back();
  to.back().gesture = 0;  // later changes of this gesture are a new entry
  edit_ = direction < 0 ? to.back().before : to.back().after;
}

std::optional<double> SplatEdits::time_of(int direction) const {
  const std::vector<Change>& changes = direction < 0 ? done_ : undone_;
  return changes.empty() ? std::nullopt : std::optional(changes.back().time);
}

bool SplatEdits::follow(Document& document, const std::function<void()>& wake) {
  if (!document.runtime || (edit_ == made_ && edit_.empty() && !coming_.valid())) return false;
  const auto place = only_splats(document.world);
  if (!place) return false;
  if (place->geometry != shown_) {  // newly received
    original_ = shown_ = place->geometry;
    made_ = {};
    failed_.reset();
  }
  bool changed = false;
  if (coming_.valid() && (came_ || coming_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)) {
    Made made = coming_.get();
    if (made.of.lock() == original_) {
      removed_ = made.removed;
      problem_ = made.geometry ? std::string()
                               : "the edited splats need " + document.world.scene->budget()->refusal(Resource::vectors);
      if (made.geometry)
        show(document, *place, std::move(made.geometry), made.edit);
      else
        failed_ = made.edit;
      changed = true;
    }
  }
  if (coming_.valid() || edit_ == made_ || edit_ == failed_) return changed;
  if (!edit_.empty()) {
    begin(document, wake);
    return changed;
  }
  removed_ = {};
  problem_.clear();
  failed_.reset();
  show(document, *place, original_, {});
  return true;
}

void SplatEdits::begin(Document& document, std::function<void()> wake) {
  came_ = false;
  const auto& stream = original_->as<qnv::Gaussians>()->stream;
  const std::size_t most = most_decoded_vectors(*document.world.scene->budget());
  coming_ =
      std::async(std::launch::async,
                 [this, original = original_, edit = edit_, budget = document.world.scene->budget(), most,
                  whole = stream ? std::optional(stream->whole()) : std::nullopt, wake = std::move(wake)]() -> Made {
                   Made made{nullptr, original, edit, {}};
                   if (whole ? most > 0 : has_room_for(*original, *budget)) {
                     qnv::Gaussians splats = whole ? whole->decode(most) : *original->as<qnv::Gaussians>();
                     made.removed = edit_splats(splats, edit);
                     made.geometry = hold_geometry(std::move(splats), budget);
                   }
                   came_ = true;  // the next step may begin before the future is ready
                   if (wake) wake();
                   return made;
                 });
}

void SplatEdits::show(Document& document, const OnlySplats& place, Shared geometry, const SplatEdit& edit) {
  ResourceUpdates updates;
  updates.geometries.push_back({place.place, {}, std::move(geometry)});
  (void)arrive(document, std::move(updates));
  shown_ = document.world.geometries.begin()->second;
  made_ = edit;
}

const SplatExtent& SplatEdits::extent(const LoadedWorld& world) {
  const auto splats = only_splats(world);
  if (!splats) return extent_ = {};
  const Shared& of = original_ && splats->geometry == shown_ ? original_ : splats->geometry;
  using namespace std::chrono_literals;
  if (extent_coming_.valid() && extent_coming_.wait_for(0s) == std::future_status::ready)
    extent_ = extent_coming_.get();
  if (extent_of_.lock() == of || extent_coming_.valid()) return extent_;
  extent_of_ = of;
  constexpr std::size_t kMeasured = 50'000;  // sampled Gaussians of a stream
  const auto& gaussians = *of->as<qnv::Gaussians>();
  if (gaussians.stream) return extent_ = extent_of_splats(gaussians.stream->overview(kMeasured));
  if (gaussians.size() <= kMostRanked) return extent_ = extent_of_splats(gaussians);
  // Until the thread is done, controls use the extent of the previous splats.
  extent_coming_ = std::async(std::launch::async, [of] { return extent_of_splats(*of->as<qnv::Gaussians>()); });
  return extent_;
}

}  // namespace gs::app
