#include "app/loading/updates/live_data.h"

#include "net/base/url.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string_view>

namespace gs::app {

std::string live_data_of(const vrml::SceneGraph& scene) {
  constexpr std::string_view kLiveMark = "live data: ";
  constexpr std::size_t kLongestUrl = 200;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    if (node.in_prototype_body || node.type->read_as != vrml::NodeKind::world_info) continue;
    for (const vrml::String& line : scene.get<vrml::MFString>(scene.nodes().id_at(i), "info"))
      if (const std::string_view text = line.view(); text.starts_with(kLiveMark) && text.size() <= kLongestUrl)
        return std::string(text.substr(kLiveMark.size()));
  }
  return {};
}

std::string live_address(const std::string& url) {
  net::Url parsed = net::parse_url(url);
  if (parsed.scheme != "ssh" || !parsed.path.ends_with(kLiveFileEnding)) return url;
  parsed.path += '/';
  return parsed.text();
}

}  // namespace gs::app
