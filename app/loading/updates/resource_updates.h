#pragma once

#include "app/loading/updates/external_prototypes.h"
#include "app/loading/updates/loaded_world.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Updates for a running world. The reader thread makes them; the thread of the world applies them.
struct ResourceUpdates {
  struct Place {
    vrml::SceneGraph* scene = nullptr;  // the root or the content of an Inline; used by the world's thread only
    vrml::NodeId node;
    std::size_t url = 0;  // index in NodeType::url_fields, for images
    // Revision of the field's urls: 0 for those of the file, one more each time they are set.
    std::uint32_t request = 0;
  };
  struct Image {
    std::vector<Place> textures;
    std::shared_ptr<const render::Image> image;  // null if it is not available
  };
  struct Content {
    Place place;                                // of an Inline
    std::shared_ptr<vrml::SceneGraph> content;  // null if it is not available
    render::MeshCache meshes;                   // of its nodes
  };
  struct Prototypes {
    vrml::SceneGraph* scene = nullptr;  // scene of the types that wait
    /// Keeps the scene of an Inline alive, so that no other one gets its address.
    std::shared_ptr<vrml::SceneGraph> scene_held;
    std::vector<AwaitedPrototype> awaited;
    std::unique_ptr<vrml::SceneGraph> library;  // null if it is not available
    std::optional<std::string> why;             // reason why `library` is null, unless it was already reported
  };
  struct Outlines {
    Place place;  // of an OutlineGroup
    std::vector<std::pair<const vrml::InterfaceDeclaration*, vrml::FieldValue>> fields;
    std::shared_ptr<const vrml::SceneGraph> held;  // scene with the budget for the polygons
  };
  struct Cloud {
    Place place;                                      // of a QNV node
    vrml::NodeId fallback;                            // PROTO instance that it replaces; null if none
    std::shared_ptr<const qnv::Geometry> cloud;       // null if it is not available
    std::shared_ptr<const render::Image> image = {};  // its texture; null if it has none
  };
  /// Sound or movie.
  struct Media {
    std::vector<Place> players;
    std::shared_ptr<const MediaFile> media;      // null if it is not available
    std::shared_ptr<const render::Image> image;  // first frame of a movie; null if there is none
  };
  /// Text that a program requested: another program, or nodes.
  struct Text {
    Place place;
    std::optional<std::string> text;                 // nullopt if it is not available
    std::string url;                                 // URL that it was read from
    std::shared_ptr<const vrml::TextSource> source;  // source of its bytes
  };

  // Defined in the source file because the members are large.
  ResourceUpdates();
  ResourceUpdates(ResourceUpdates&& other) noexcept;
  ResourceUpdates& operator=(ResourceUpdates&& other) noexcept;
  ~ResourceUpdates();

  std::vector<Text> texts;
  std::vector<Content> contents;  // applied before the updates of their nodes
  std::vector<Prototypes> prototypes;
  std::vector<Outlines> outlines;
  std::vector<Image> images;
  std::vector<Media> media;
  std::vector<Cloud> clouds;
  std::vector<std::shared_ptr<StreamFeed>> feeds;
  std::vector<UrlProgress> progress;
  Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;

  [[nodiscard]] bool empty() const {
    return contents.empty() && prototypes.empty() && outlines.empty() && images.empty() && media.empty() &&
           clouds.empty() && feeds.empty() && progress.empty() && texts.empty() && diagnostics.entries().empty() &&
           outside.empty();
  }
  /// Appends later updates.
  void append(ResourceUpdates&& later);
};

/// Request to fetch urls of a running world. They were set, or belong to a node that was made at run time, or to an
/// EXTERNPROTO in a text that was read at run time.
struct UrlRequest {
  ResourceUpdates::Place place;
  const vrml::Node* node = nullptr;  // determines the importance; must not be dereferenced by the reader thread
  vrml::UrlContent content = vrml::UrlContent::none;
  bool as_text = false;  // requests the text itself instead of `content`
  /// EXTERNPROTO that waits for its body, or null; must not be dereferenced by the reader thread.
  vrml::NodeType* prototype = nullptr;
  vrml::MFString urls;
  std::shared_ptr<const vrml::TextSource> source;  // of the text that contains the URLs
  bool fetched = false;                            // that text was read from a URL at run time
  bool computed = false;                           // a Script may have computed the URLs
  std::string type, file;                          // of the node: its type and the file of its text, for messages
  SourceLocation location;
};

/// Gives a QNV node its vectors. The node's own transfer function overrides that of the stream.
void set_cloud(LoadedWorld& world, const ResourceUpdates::Cloud& update, Diagnostics& diagnostics);
/// Gives an OutlineGroup its polygons.
void set_outlines(LoadedWorld& world, const ResourceUpdates::Outlines& update);
/// Applies all updates except `contents`, `prototypes`, `progress` and `outlines`; the last two become events. Returns
/// the nodes with a changed appearance.
[[nodiscard]] std::vector<ResourceUpdates::Place> take_in(LoadedWorld& world, ResourceUpdates&& updates);

}  // namespace gs::app
