#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Targets of an Anchor (VRML97 6.2).
struct Link {
  struct Place {
    std::string target;        // path or URL without a fragment; empty means the same world
    std::string viewpoint;     // fragment: DEF name of a Viewpoint; may be empty
    bool for_browser = false;  // a file type that only a web browser opens
    bool is_file = false;      // `target` is the path of a file: URL
    std::string problem;       // reason why it must not be opened; empty if it may be
  };
  std::vector<Place> places;  // in the order of the url list
  bool other_window = false;  // "target=" in `parameter` names another frame
};

/// File or URL that the user gave. A suffix "#NAME" names the initial Viewpoint (VRML97 4.5.2), unless a file has this
/// name. A link to a scene (link_file.h) is resolved to its target.
struct GivenPlace {
  std::string target, viewpoint;
  std::size_t budget = 0;  // vectors that a link asks for; 0 means none
  std::string problem;     // error of a link; `target` is then the link itself
};
[[nodiscard]] GivenPlace given_place(const std::string& path_or_url);

/// Returns the link of an Anchor node. A world from the network can only link to the network.
[[nodiscard]] Link link_of(const vrml::SceneGraph& scene, vrml::NodeId anchor);

/// Returns the link of the url and parameter lists of a text (VRML97 4.12.10, loadURL). `text` is the file that
/// contains the text, `source` the source of the text itself; null means that of the file.
[[nodiscard]] Link link_of(const std::vector<std::string>& urls, const std::vector<std::string>& parameters,
                           const vrml::SourceText& text,
                           const std::shared_ptr<const vrml::TextSource>& source = nullptr);

/// Refuses missing files of a link, and files outside of the folder of `text` and of the folders that the user
/// `allowed`. Applies to loadURL of --control clients, and of Scripts in worlds that such clients have changed.
void keep_to_readable_files(Link& link, const vrml::SourceText& text, const std::vector<std::string>& allowed);

/// Opens an http(s) URL in the default web browser of the desktop. Returns false if no browser could be started.
bool open_in_browser(const std::string& url);

}  // namespace gs::app
