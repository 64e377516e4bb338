#pragma once

#include "app/world/external_prototypes.h"
#include "app/world/opened_world.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// What has come for a world that lives already: made by the thread that reads, taken in by the one that owns the
/// world.
struct Arrivals {
  struct Place {
    vrml::SceneGraph* scene = nullptr;  // the root or the content of an Inline; touched by the world's thread only
    vrml::NodeId node;
    std::size_t url = 0;  // of NodeType::url_fields, for images
    // Which of the urls that the field has had: 0 that of the file, then one more each time it is set.
    std::uint32_t request = 0;
  };
  struct Image {
    std::vector<Place> textures;
    std::shared_ptr<const render::Image> image;  // null: there is none
  };
  struct Content {
    Place place;                                // of an Inline
    std::shared_ptr<vrml::SceneGraph> content;  // null: there is none
    render::MeshCache meshes;                   // of its nodes
  };
  struct Prototypes {
    vrml::SceneGraph* scene = nullptr;             // of the types that wait
    std::shared_ptr<vrml::SceneGraph> scene_held;  // where it is an Inline's: so that no other one takes its place
    std::vector<AwaitedPrototype> awaited;
    std::unique_ptr<vrml::SceneGraph> library;  // null: there is none
    std::optional<std::string> why;             // there is none, where that has not been said yet
  };
  struct Outlines {
    Place place;  // of an OutlineGroup
    std::vector<std::pair<const vrml::InterfaceDeclaration*, vrml::FieldValue>> fields;
    std::shared_ptr<const vrml::SceneGraph> held;  // whose budget they are drawn from
  };
  struct Cloud {
    Place place;                                      // of a QNV node
    vrml::NodeId fallback;                            // the PROTO instance in whose place it is shown; null: none
    std::shared_ptr<const qnv::Cloud> cloud;          // null: there is none
    std::shared_ptr<const render::Image> image = {};  // of its picture; null: there is none
  };
  /// A sound or movie.
  struct Media {
    std::vector<Place> players;
    std::shared_ptr<const MediaFile> media;      // null: there is none
    std::shared_ptr<const render::Image> image;  // of a movie, the first; null: there is none
  };
  /// A text that a program has asked for: another program, or nodes.
  struct Text {
    Place place;
    std::optional<std::string> text;                 // none: it cannot be had
    std::string url;                                 // where it was found
    std::shared_ptr<const vrml::TextSource> source;  // of its bytes
  };

  // Not in each file that has arrivals: they are long.
  Arrivals();
  Arrivals(Arrivals&& other) noexcept;
  Arrivals& operator=(Arrivals&& other) noexcept;
  ~Arrivals();

  std::vector<Text> texts;
  std::vector<Content> contents;  // in front of all that belongs into them
  std::vector<Prototypes> prototypes;
  std::vector<Outlines> outlines;
  std::vector<Image> images;
  std::vector<Media> media;
  std::vector<Cloud> clouds;
  std::vector<std::shared_ptr<StreamFeed>> feeds;
  std::vector<UrlProgress> progress;
  vrml::Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;

  [[nodiscard]] bool empty() const {
    return contents.empty() && prototypes.empty() && outlines.empty() && images.empty() && media.empty() &&
           clouds.empty() && feeds.empty() && progress.empty() && texts.empty() && diagnostics.entries().empty() &&
           outside.empty();
  }
  /// Puts what has come later behind.
  void append(Arrivals&& later);
};

/// The url of a node of a living world was set, or is that of a node made at run time, or of an EXTERNPROTO of a text
/// read then.
struct UrlRequest {
  Arrivals::Place place;
  const vrml::Node* node = nullptr;  // whose importance counts; not to be looked at by the thread that reads
  vrml::UrlContent content = vrml::UrlContent::none;
  bool as_text = false;                 // in place of that: the text itself
  vrml::NodeType* prototype = nullptr;  // the EXTERNPROTO that waits for its body; likewise. Null: it is the node's
  vrml::MFString urls;
  std::shared_ptr<const vrml::TextSource> source;  // of the text that names the URLs
  bool fetched = false;                            // that text was read from a URL at run time
  bool computed = false;                           // a Script may have computed the URLs
  std::string type, file;                          // of the node, and place in its text, for messages
  vrml::SourceLocation location;
};

/// Gives a QNV node its vectors; a transfer function of its own goes before that of the stream.
void set_cloud(OpenedWorld& world, const Arrivals::Cloud& arrival);
/// Gives an OutlineGroup its polygons.
void set_outlines(OpenedWorld& world, const Arrivals::Outlines& arrival);
/// Gives all to the world but `progress` and `outlines`, which are its events', `contents` and `prototypes`. The nodes
/// that look otherwise from then on.
[[nodiscard]] std::vector<Arrivals::Place> take_in(OpenedWorld& world, Arrivals&& arrivals);

}  // namespace gs::app
