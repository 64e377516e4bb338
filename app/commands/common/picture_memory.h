#pragma once

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

// Memory management of processes that draw one picture and end.

/// Makes the allocator keep freed memory. Returning memory to the system and getting it back takes a third of the time
/// of a picture. If the system offers large pages on request, all threads share one heap of large pages, and its
/// addresses are reserved now. Without large pages, threads would only wait for a shared heap. Call at the start.
void keep_memory();

/// Frees the large number lists of geometry nodes. Call after the meshes are made, before the driver copies the meshes.
/// The lists must not be read afterwards.
void release_lists(vrml::SceneGraph& scene);

}  // namespace gs::app
