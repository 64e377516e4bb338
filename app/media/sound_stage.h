#pragma once

#include "app/media/hearing.h"
#include "app/media/mixer.h"
#include "render/scene/collect_schema.h"
#include "render/scene/render_list.h"
#include "vrml/events/execution.h"

#include <glm/mat4x4.hpp>

#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app {

/// The sounds and movies of a world, by the nodes that play them.
using MediaFiles = std::unordered_map<const vrml::Node*, std::shared_ptr<const MediaFile>>;

/// What is heard of worlds: their Sounds, by where the viewer is, become voices of a mixer. One thread, but for the
/// mixer.
class SoundStage {
 public:
  /// For one moment: `begin`, each world that is heard, `end`.
  void begin() { heard_.clear(); }
  /// `list` is up to date.
  void add(const render::RenderList& list, vrml::Execution& execution, const MediaFiles& media,
           const glm::dmat4& world_from_viewer);
  void end(double now);

  void set_muted(bool muted);
  [[nodiscard]] bool muted() const { return muted_; }
  /// Steps of kVolumeStep dB up or down, from kLeastVolume to 0.
  void change_volume(int steps);
  [[nodiscard]] int volume() const { return volume_; }  // dB
  static constexpr int kVolumeStep = 3, kLeastVolume = -36;

  [[nodiscard]] Mixer& mixer() { return mixer_; }

 private:
  void set_gain();

  Mixer mixer_;
  render::Schemas schemas_;
  std::vector<std::pair<SoundRank, Voice>> heard_;
  bool muted_ = false;
  int volume_ = 0;
};

}  // namespace gs::app
