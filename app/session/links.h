#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Where an Anchor leads (VRML97 6.2).
struct Link {
  struct Place {
    std::string target;        // a path or URL without a fragment; empty: the same world
    std::string viewpoint;     // the fragment: DEF name of a Viewpoint; may be empty
    bool for_browser = false;  // no kind of file that is opened here
    bool is_file = false;      // `target` is the path of a file: URL
    std::string problem;       // why it may not be gone to; empty: it may
  };
  std::vector<Place> places;  // in the order of the url list
  bool other_window = false;  // "target=" in `parameter` names another frame
};

/// A file or URL as the user gives it: "#NAME" behind it is the Viewpoint to begin at (VRML97 4.5.2), unless a file is
/// called so. A link to a scene (link_file.h) is the place where it leads.
struct GivenPlace {
  std::string target, viewpoint;
  std::size_t budget = 0;  // vectors that a link asks for; 0: none
  std::string problem;     // what is wrong with a link, which is the target then
};
[[nodiscard]] GivenPlace given_place(const std::string& path_or_url);

/// Of an Anchor node. A world of the network leads to the network only.
[[nodiscard]] Link link_of(const vrml::SceneGraph& scene, vrml::NodeId anchor);

/// Link of the url and parameter lists of a text (VRML97 4.12.10, loadURL). `text` is the file that the text belongs to,
/// `source` the source of the text itself; null means that of the file.
[[nodiscard]] Link link_of(const std::vector<std::string>& urls, const std::vector<std::string>& parameters,
                           const vrml::SourceText& text,
                           const std::shared_ptr<const vrml::TextSource>& source = nullptr);

/// Refuses the files of a link that lie outside of the folder of `text` and of the folders that the user `allowed`, and
/// those that are missing. Applies to loadURL of clients of --control, and of Scripts in worlds that they have changed.
void keep_to_readable_files(Link& link, const vrml::SourceText& text, const std::vector<std::string>& allowed);

/// Gives an http(s) URL to the program that the desktop has for it. False: none can be started.
bool open_in_browser(const std::string& url);

}  // namespace gs::app
