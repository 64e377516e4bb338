#pragma once

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

// What a program that makes one picture does with its memory.

/// A picture's program ends when it is written: memory that is given back to the system, and taken again page by page,
/// is a third of its time. So blocks are kept. Where the system has large pages for who asks, they come from one heap
/// for all threads, whose addresses are taken here, at the beginning; elsewhere threads would only wait for each other.
void keep_memory();

/// Geometries are meshes by now, and nobody reads the lists of numbers that they were made of again: large ones give
/// their memory back before the driver makes copies of its own.
void release_lists(vrml::SceneGraph& scene);

}  // namespace gs::app
