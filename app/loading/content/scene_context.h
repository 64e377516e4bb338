#pragma once

#include "app/loading/fetch/loading.h"

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

class ImageHandler;
class MediaHandler;
class OutlineHandler;
class SceneHandler;
struct SharedGeometry;

/// Parts that the scene handlers of one world share.
struct SceneContext {
  explicit SceneContext(Loading& the_loading) : loading(the_loading) {}

  Loading& loading;
  std::vector<std::shared_ptr<OutlineHandler>> outlines;  // handlers with new polygons
  std::vector<std::shared_ptr<SceneHandler>> withheld;    // Inlines that wait until their file is complete
  // Resources that several nodes share. The keys are from fetch_key().
  std::unordered_map<std::string, std::shared_ptr<ImageHandler>> images;
  std::unordered_map<std::string, std::shared_ptr<SharedGeometry>> geometries;
  std::unordered_map<std::string, std::shared_ptr<MediaHandler>> media;
};

}  // namespace gs::app
