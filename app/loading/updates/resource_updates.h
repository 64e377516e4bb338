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
    vrml::SceneGraph* scene = nullptr;  // root or content of an Inline; only the world's thread uses it
    vrml::NodeId node;
    std::size_t url = 0;  // for images: index in NodeType::url_fields
    // Revision of the field's urls. 0 means those of the file. Each change of the field adds 1.
    std::uint32_t request = 0;
  };
  struct Image {
    std::vector<Place> textures;
    std::shared_ptr<const render::Image> image;  // null if the image is unavailable
  };
  struct Content {
    Place place;                                // the Inline
    std::shared_ptr<vrml::SceneGraph> content;  // null if the content is unavailable
    render::MeshCache meshes;                   // meshes of the nodes in `content`
  };
  struct Prototypes {
    vrml::SceneGraph* scene = nullptr;  // scene that owns the waiting types
    /// Owner of an Inline's scene. Prevents another scene from getting the same address.
    std::shared_ptr<vrml::SceneGraph> scene_held;
    std::vector<AwaitedPrototype> awaited;
    std::unique_ptr<vrml::SceneGraph> library;  // null if the library is unavailable
    std::optional<std::string> why;             // reason why `library` is null; nullopt if already reported
  };
  struct Outlines {
    Place place;  // the OutlineGroup
    std::vector<std::pair<const vrml::InterfaceDeclaration*, vrml::FieldValue>> fields;
    std::shared_ptr<const vrml::SceneGraph> held;  // scene with the memory shares of the polygons
  };
  struct Geometry {
    Place place;                                      // the QNV node
    vrml::NodeId fallback;                            // PROTO instance that the QNV node replaces, or null
    std::shared_ptr<const qnv::Geometry> geometry;    // null if the vectors are unavailable
    std::shared_ptr<const render::Image> image = {};  // texture for the vectors, or null
  };
  /// Sound or movie.
  struct Media {
    std::vector<Place> players;
    std::shared_ptr<const MediaFile> media;      // null if the media file is unavailable
    std::shared_ptr<const render::Image> image;  // first frame of a movie, or null
  };
  /// Text that a program requested: another program, or VRML nodes.
  struct Text {
    Place place;
    std::optional<std::string> text;                 // nullopt if the text is unavailable
    std::string url;                                 // URL of the text
    std::shared_ptr<const vrml::TextSource> source;  // source of the text
  };

  // Defined in the source file because the members are large.
  ResourceUpdates();
  ResourceUpdates(ResourceUpdates&& other) noexcept;
  ResourceUpdates& operator=(ResourceUpdates&& other) noexcept;
  ~ResourceUpdates();

  std::vector<Text> texts;
  std::vector<Content> contents;  // applied before updates of nodes inside the contents
  std::vector<Prototypes> prototypes;
  std::vector<Outlines> outlines;
  std::vector<Image> images;
  std::vector<Media> media;
  std::vector<Geometry> geometries;
  std::vector<std::shared_ptr<StreamFeed>> feeds;
  std::vector<UrlProgress> progress;
  Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;

  [[nodiscard]] bool empty() const {
    return contents.empty() && prototypes.empty() && outlines.empty() && images.empty() && media.empty() &&
           geometries.empty() && feeds.empty() && progress.empty() && texts.empty() && diagnostics.entries().empty() &&
           outside.empty();
  }
  /// Appends the newer updates `later`.
  void append(ResourceUpdates&& later);
};

/// Request to fetch urls for a running world. Three kinds of urls need it: urls that were set, urls of a node created
/// at run time, and urls of an EXTERNPROTO in a text read at run time.
struct UrlRequest {
  ResourceUpdates::Place place;
  const vrml::Node* node = nullptr;  // source of the importance; the reader thread must not dereference it
  vrml::UrlContent content = vrml::UrlContent::none;
  bool as_text = false;  // requests the text itself, not the node's content
  /// EXTERNPROTO that waits for its body, or null. The reader thread must not dereference it.
  vrml::NodeType* prototype = nullptr;
  vrml::MFString urls;
  std::shared_ptr<const vrml::TextSource> source;  // source of the text that contains the URLs
  bool fetched = false;                            // true if that text was read from a URL at run time
  bool computed = false;                           // true if a Script may have computed the URLs
  bool refresh = false;                            // loads the same URLs again, even if they were read before
  std::string type, file;                          // type of the node and file of its text, for messages
  SourceLocation location;
  bool in_x3d = false;  // the node is in an X3D text
};

/// Shows vectors in a QNV node. The node's own transfer function overrides the stream's.
void set_geometry(LoadedWorld& world, const ResourceUpdates::Geometry& update, Diagnostics& diagnostics);
/// Sets the polygons of an OutlineGroup.
void set_outlines(LoadedWorld& world, const ResourceUpdates::Outlines& update);
/// Applies updates to a world. The caller must apply `contents` and `prototypes`, and send `progress` and `outlines` as
/// events. Returns the nodes with a changed appearance.
[[nodiscard]] std::vector<ResourceUpdates::Place> take_in(LoadedWorld& world, ResourceUpdates&& updates);

}  // namespace gs::app
