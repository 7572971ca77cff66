#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/xfem/enrichment.hpp"

#include <map>
#include <set>

namespace pdx::xfem {
/// A straight part of cracks inside a cell, between two vertices.
struct NetWall {
  int from, to;
  std::set<int> cracks;
};

/// Part of a cell's border between two vertices, counter-clockwise.
struct NetShare {
  int from, to;
  int edge;          ///< from corner `edge` to the next
  double begin, end; ///< fractions of it
  bool open;         ///< a crack runs along it
};

/// Cracks over cells as a plane graph: vertices are the nodes, where cracks cross edges, where they bend, end and meet.
/// What is nearer than the tolerance is one vertex: nodes take it first, then edges, then other vertices. What happens
/// on an edge is decided once, from its nodes in order of their numbers, so that its two cells see the same; cracks lie
/// where they are but for the tolerance. An end on another crack is moved on to it, a mouth prolonged.
class CrackNet {
public:
  /// @param view its active cells are those of the net; numbers of nodes mean the same on every rank
  CrackNet(const MeshView& view, const crack::CrackSet& cracks, double tolerance);

  std::size_t cells() const { return cells_.size(); } ///< in order of `view.active`
  const Vector<2>& point(int vertex) const
  {
    return vertices_[static_cast<std::size_t>(vertex)].at;
  } ///< a node's number is its own
  std::vector<NetShare> border(std::size_t cell) const;
  const std::vector<NetWall>& walls(std::size_t cell) const { return cells_[cell].walls; }
  /// Do several cracks pass or end at a vertex on the border of a cell?
  bool meet_on_border(std::size_t cell) const;

private:
  using Edge = std::pair<Index, Index>; // nodes, the lower first
  struct Mark {
    double at; // fraction of the edge
    int vertex;
  };
  struct EdgeMarks {
    std::vector<std::size_t> cells;
    std::vector<Mark> marks;               // ascending, nodes not among them
    std::vector<std::pair<int, int>> open; // from vertex to vertex
  };
  struct Vertex {
    Vector<2> at;
    std::vector<Edge> edges;        // that it lies on
    std::vector<std::size_t> cells; // that it lies in or on the border of
    std::set<int> cracks = {};
  };
  struct Cell {
    std::array<Index, 4> nodes;
    std::vector<int> inside; // vertices
    std::vector<NetWall> walls;
  };
  struct Spot { // of cracks: where they bend, end and meet
    Vector<2> at;
    int vertex = -1;
  };
  struct OnSegment {
    double at; // fraction of it
    std::size_t spot;
  };
  struct Segment {
    int crack;
    Vector<2> from, to;
    std::vector<OnSegment> spots;
  };

  void find_segments(const crack::CrackSet& cracks);
  void find_spots();
  std::size_t spot_at(const Vector<2>& x);
  int vertex_at(const Vector<2>& x);
  int mark(const Edge& edge, double at);
  void run(const Segment& segment);
  void run(int crack, int from, int to);
  void add(int from, int to, const std::set<int>& cracks);
  bool refine(std::size_t cell);
  void split(std::size_t cell, std::size_t wall, int vertex);
  int crossing(std::size_t cell, const NetWall& a, const NetWall& b);
  bool is_near(const Vector<2>& a, const Vector<2>& b) const;
  std::vector<int> vertices_of(const Cell& cell) const;
  /// Vertices along an edge, from its lower node on, with their fractions.
  std::vector<Mark> along(const Edge& edge) const;
  static Edge edge_between(Index a, Index b) { return std::minmax(a, b); }

  double tolerance_;
  Vector<2> lower_, upper_; // of all cells, and the tolerance
  std::vector<Vertex> vertices_;
  std::map<Edge, EdgeMarks> edges_;
  std::vector<Cell> cells_;
  std::vector<Segment> segments_;
  std::vector<Spot> spots_;
};
} // namespace pdx::xfem
