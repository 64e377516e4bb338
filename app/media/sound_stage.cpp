#include "app/media/sound_stage.h"

#include "vrml/behaviours/browser_events.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gs::app {

void SoundStage::add(const render::RenderList& list, vrml::Execution& execution, const MediaFiles& media,
                     const glm::dmat4& world_from_viewer) {
  if (media.empty()) return;
  std::unordered_map<const vrml::Node*, std::size_t> places;  // instances of each Sound node so far
  for (const render::SoundState& sound : render::sounds_of(list, schemas_)) {
    const std::size_t number = places[sound.node]++;
    const auto file = media.find(&sound.scene->node(sound.source));
    if (file == media.end() || !file->second->info.sound) continue;
    const auto play = vrml::media_play(execution, *sound.scene, sound.source);
    // Skip sounds that are stopped or play backwards.
    if (!play || !play->active || !(play->rate > 0)) continue;
    const Heard heard = sound_attenuation(sound, world_from_viewer);
    if (heard.level <= 0) continue;
    Voice voice;
    voice.who = sound.node;
    voice.number = number;
    voice.file = file->second;
    voice.start = play->start;
    voice.end = play->end;
    voice.rate = play->rate;
    voice.duration = play->duration;
    voice.loop = play->loop;
    voice.left = heard.left;
    voice.right = heard.right;
    heard_.emplace_back(SoundRank{sound.priority, play->start, heard.level}, std::move(voice));
  }
}

void SoundStage::end(double now) {
  std::stable_sort(heard_.begin(), heard_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (heard_.size() > kMaxVoices) heard_.resize(kMaxVoices);
  std::vector<Voice> voices;
  voices.reserve(heard_.size());
  for (auto& [rank, voice] : heard_) voices.push_back(std::move(voice));
  heard_.clear();
  mixer_.set(std::move(voices), now);
}

void SoundStage::set_gain() { mixer_.set_gain(muted_ ? 0 : std::pow(10, volume_ / 20.0)); }

void SoundStage::set_muted(bool muted) {
  muted_ = muted;
  set_gain();
}

void SoundStage::change_volume(int steps) {
  volume_ = std::clamp(volume_ + steps * kVolumeStep, kMinVolume, 0);
  muted_ = muted_ && steps < 0;
  set_gain();
}

}  // namespace gs::app
