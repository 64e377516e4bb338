#pragma once

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

// Memory settings for processes that draw one picture.

/// Makes the allocator keep freed memory. Returning pages to the system and faulting them in again takes a third of the
/// time of a picture. If the system has large pages on request, all threads use one heap of them, and its addresses are
/// reserved here. Otherwise a single heap would only make threads wait. Call at the start.
void keep_memory();

/// Frees the large number lists of geometries after their meshes are made, before the driver makes own copies. Nothing
/// may read the lists afterwards.
void release_lists(vrml::SceneGraph& scene);

}  // namespace gs::app
