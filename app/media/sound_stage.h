#pragma once

#include "app/media/mixer.h"
#include "app/media/sound_attenuation.h"
#include "render/collection/nodes/collect_schema.h"
#include "render/scene/render_list.h"
#include "vrml/events/execution.h"

#include <glm/mat4x4.hpp>

#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app {

/// Media files of a world, by the node that plays each file.
using MediaFiles = std::unordered_map<const vrml::Node*, std::shared_ptr<const MediaFile>>;

/// Converter from the Sounds of worlds to the voices of a mixer, by the viewer's position. One thread; only mixer() may
/// be used on other threads.
class SoundStage {
 public:
  /// Begins the set of sounds of one frame. In each frame call begin(), then add() for every audible world, then end().
  void begin() { heard_.clear(); }
  /// Adds the audible sounds of one world. `list` must be updated to the present frame.
  void add(const render::RenderList& list, vrml::Execution& execution, const MediaFiles& media,
           const glm::dmat4& world_from_viewer);
  void end(double now);

  void set_muted(bool muted);
  [[nodiscard]] bool muted() const { return muted_; }
  /// Changes the volume by `steps` times kVolumeStep dB. Clamps it to kMinVolume..0 dB.
  void change_volume(int steps);
  [[nodiscard]] int volume() const { return volume_; }  // dB
  static constexpr int kVolumeStep = 3, kMinVolume = -36;

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
