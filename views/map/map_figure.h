// views/map/map_figure.h – plot files and wishes become panels with one scale, ready to be drawn. No pens, no
// paper.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/results/result_file.h"
#include "views/map/colour_map.h"
#include "views/map/map_geometry.h"

namespace dea {

struct MapOptions {
  std::string field = "contact pressure";
  std::vector<std::string> surfaces;  ///< empty: the one with springs, or the highest pressure in the first file
  std::string states = "last";        ///< all, last, or times t1,t2,...
  std::string states_option;          ///< how the user calls it, for messages: "--at 1,2"
  std::optional<Vector3d> toward;     ///< seen from there; none: along the surface's axis
  bool unrolled = false;
  Vector3d up = Vector3d::Zero();    ///< zero: found
  BodyDirections body;               ///< with anterior: named at the edges of maps
  bool load = false;                 ///< an arrow for the force that presses the surface
  bool labelled = false;             ///< titles name the file also where it is the only one
  bool smooth = false;               ///< nodal averages, interpolated; else facets as they are
  bool scale_of_shown = false;       ///< the scale covers the panels; else all states of the files
  std::optional<ColourMap> colours;  ///< none: Sequential, of differences Diverging
  std::optional<double> low, high;
  std::optional<std::vector<double>> contours;  ///< none: at the colour bar's ticks
};

/// A surface of one file on the map.
struct MapSurface {
  std::string name;
  ResultSurface surface;
  MapMesh mesh;
  MapView view;
  EdgeNames edges = {};
  Projection projection;
};

struct MapPanel {
  std::string title;
  std::string when;                  ///< the end of the title that is never cut
  std::vector<std::string> numbers;  ///< a line of numbers, and shorter ones for narrow panels
  bool solved = true;                ///< false: its numbers say that the state is no solution
  int surface = 0;                   ///< index into MapFigure::surfaces
  std::vector<double> facets;        ///< NaN: nothing there (no contact)
  std::vector<double> points;        ///< per point of the map: nodal averages; NaN: nothing there
  double edge = 0.0;  ///< smooth: the level of `points` that encloses as much area as the facets with a value
  std::optional<Vector2d> peak, center_of_pressure;  ///< on the map; none where not to be seen
  std::optional<Vector2d> load;  ///< direction of the force on this surface, on the map: shorter than 1 as it is turned
};

/// What the legend explains: what panels have.
struct MapSigns {
  bool peak = false, center_of_pressure = false, load = false, nothing = false, turned_away = false;
};

struct MapFigure {
  std::string title;
  std::vector<MapSurface> surfaces;
  std::vector<MapPanel> panels;
  int columns = 0;  ///< of panels; 0: as fits
  ColourMap map = ColourMap::Sequential;
  bool smooth = false, pressure = true;
  bool empty = false;  ///< not one value: there is no scale
  double low = 0.0, high = 1.0;
  bool beyond_low = false, beyond_high = false;  ///< values outside the scale exist
  std::vector<double> ticks, contours;
  MapSigns signs;
  std::string quantity, unit, length_unit, force_unit;  ///< units: empty if the files name none
  std::vector<std::string> remarks;  ///< for the user: what is not to be seen, what is cut off or missing
};

/// Is every state on the map a solution?
bool all_solved(const MapFigure& figure);

/// `minus`: the result to take away, on the same surface; nullptr: none. Throws InputError: no such field, surface or
/// state, no scalar; UsageError: a surface that cannot be unrolled, a scale without width.
MapFigure make_map_figure(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options);

/// The states of MapOptions one after the other, each a figure of its own, all with one scale, view and legend: frames
/// of an animation. Holds one at a time. Returns the remarks, which each figure has too.
std::vector<std::string> each_map_figure(const std::vector<ResultFile>& files, const ResultFile* minus,
                                         const MapOptions& options,
                                         const std::function<void(MapFigure& figure, int frame, int frames)>& show);

}  // namespace dea
