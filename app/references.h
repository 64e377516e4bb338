#pragma once

#include "app/load_limit.h"
#include "net/file.h"
#include "net/url.h"
#include "render/image.h"
#include "render/render_list.h"
#include "vrml/diagnostic.h"
#include "vrml/scene_graph.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What nodes refer to, by node.
struct References {
  render::Images& images;
  render::Clouds& clouds;  // nodes that are in it already are left alone
};

/// Loads what the live nodes of a world refer to: EXTERNPROTOs, Inlines (with all of this again for their
/// content), the images of textures and the vectors of QNV nodes. Of each url list the first entry that works is taken
/// (VRML97 4.5.2); what is missing gives a warning and is left out. Inlines and EXTERNPROTOs that contain themselves
/// are cut. Stops with a diagnostic at `limit`.
void load_references(vrml::SceneGraph& scene, const std::string& path, References found, vrml::Diagnostics& diagnostics,
                     const LoadLimit& limit);

/// The local file that `reference` means, seen from `base`; also where only upper and lower case differ,
/// as in worlds that come from Windows. Nothing when there is none.
[[nodiscard]] std::optional<net::MappedFile> open_reference(const net::Url& base, std::string_view reference,
                                                            std::string* path = nullptr);

/// The bytes of a data: URL (RFC 2397); nothing when it is none or is malformed.
[[nodiscard]] std::optional<std::vector<std::byte>> data_of_url(std::string_view url);

}  // namespace gs::app
