#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Link of an Anchor or of loadURL, with all its targets (VRML97 6.2).
struct Link {
  struct Place {
    std::string target;  // path or URL without its fragment; empty means the present world
    std::string viewpoint;  // fragment, which is the DEF name of a Viewpoint; empty if there is none
    bool for_browser = false;  // `target` must be opened by a web browser
    bool is_file = false;  // `target` is a path from a file: URL
    std::string problem;  // reason why `target` must not be opened; empty if it may be opened
  };
  std::vector<Place> places;  // in the order of the url list
  bool other_window = false;  // "target=" in `parameter` names another frame
};

/// File or URL that the user entered. "#NAME" at its end names the initial Viewpoint (VRML97 4.5.2), unless a file has
/// this full name. A link to a scene (link_file.h) is replaced by its target.
struct GivenPlace {
  std::string target, viewpoint;
  std::size_t budget = 0;  // vector budget that a link sets; 0 means none
  std::string problem;  // error in a link to a scene; then `target` is the link itself
};
[[nodiscard]] GivenPlace given_place(const std::string& path_or_url);

/// Returns the link of an Anchor node. If the world is from the network, its links cannot open local files.
[[nodiscard]] Link link_of(const vrml::SceneGraph& scene, vrml::NodeId anchor);

/// Returns the link for the url and parameter lists of loadURL (VRML97 4.12.10). `text` is the file that contains the
/// program. `source` is the source of the program's own text; null means that of `text`.
[[nodiscard]] Link link_of(const std::vector<std::string>& urls, const std::vector<std::string>& parameters,
                           const vrml::SourceText& text,
                           const std::shared_ptr<const vrml::TextSource>& source = nullptr);

/// Refuses files of a link that do not exist. Also refuses files outside of both the folder of `text` and the `allowed`
/// folders. Used for loadURL of --control clients, and of Scripts in worlds that such clients have changed.
void keep_to_readable_files(Link& link, const vrml::SourceText& text, const std::vector<std::string>& allowed);

/// Opens an http, https or mailto URL in the default web browser of the desktop. Returns false if no browser could be
/// started.
bool open_in_browser(const std::string& url);

}  // namespace gs::app
