// The cognitive map: places that the robot has been to, and the ways between them.
//
//   node e_i = { p_i, V_i, L_i }                                                  docs/papers.md (18)
//     p   where the robot believed to be: its pose in the plane, and the grid cells' activity there
//     V   what it saw: a visual template
//     L   links to other nodes, each with the motion that leads there
//   e_new = { p, V, L + Delta L }     made where the position has moved on or the scene is new  (19, 20)
//
// The map is semi-metric: its links are measured, its poses are what agrees with them best
// (slam/brain/map/relaxation.h). Memory: a node takes about 7 kB, nearly all of it its template.
#pragma once

#include <vector>

#include "slam/brain/motion/plane.h"
#include "slam/brain/templates/place_geometry.h"

namespace penumbra::slam::brain {

struct Link {
  int from = 0, to = 0;                  // nodes
  PlanePose motion;                      // of `to`, measured in the frame of `from`
  bool recalled = false;                 // by a template that was seen again, not by the robot's own motion
  double metres = 0.05, radians = 0.01;  // standard deviations of `motion`
};

struct Node {
  int frame = 0;           // in which it was made
  double timestamp = 0.0;  // seconds
  PlanePose pose;
  std::vector<float> activity;     // of the grid cells
  std::vector<PlacePoint> points;  // what proves the place; the template is the one of the node's number
  double strength = 0.0;           // of the tie between template and place, (10)
};

class CognitiveMap {
 public:
  // Returns the node's number. The first is the map's origin and stays where it is.
  int add(Node node);
  // Throws UsageError for ends that are equal or no nodes.
  void add(const Link& link);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Link>& links() const { return links_; }
  const Node& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  Node& node(int i) { return nodes_[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(nodes_.size()); }
  // Numbers of the links at a node, in the order in which they were added.
  const std::vector<int>& links_of(int node) const { return links_of_[static_cast<std::size_t>(node)]; }
  // Fewest links between two nodes, at most `most`; `most` + 1 where there are more.
  int hops(int from, int to, int most) const;

  // Approximately, of all that it holds.
  std::size_t bytes() const;

 private:
  std::vector<Node> nodes_;
  std::vector<Link> links_;
  std::vector<std::vector<int>> links_of_;
};

}  // namespace penumbra::slam::brain
