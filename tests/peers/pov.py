#!/usr/bin/env python3
"""Writes the scene of glass.py for POV-Ray.

usage: pov.py FILE.pov

The closed bodies of hulls(), as meniscus takes them: POV-Ray keeps a list of the interiors that a ray has entered. It is
no path tracer: at every surface a ray is split in two, so that 12 levels with a bailout stand for our 64 bounces; light
through the glass comes from photons, that of the sky from radiosity.
SPDX-License-Identifier: Apache-2.0
"""
import math
import sys

import glass

HEAD = """#version 3.7;
global_settings {{
  assumed_gamma 1  max_trace_level 12  adc_bailout .01
  radiosity {{ pretrace_start .08 pretrace_end .02 count 60 error_bound .6 recursion_limit 1 brightness 1 }}
  photons {{ count 200000 max_trace_level 12 }}
}}
background {{ rgb <{sky}> }}
camera {{ perspective location <{camera}> right x up y angle {fov} look_at <{target}> }}
"""


def point(v):
    """POV-Ray's z points away."""
    return "%.7g, %.7g, %.7g" % (v[0], v[1], -v[2])


def mesh_text(mesh):
    vertices = ", ".join(f"<{point(v)}>" for v in mesh.vertices)
    faces = ", ".join("<%d, %d, %d>" % t for t in mesh.triangles)
    return (f"mesh2 {{ vertex_vectors {{ {len(mesh.vertices)}, {vertices} }}\n"
            f"face_indices {{ {len(mesh.triangles)}, {faces} }}\ninside_vector <.1, 1, .05>\n")


def lamp_text():
    """A square of 9 x 9 lights; POV-Ray's lights have no unit: a colour of 1 lights a white surface to 1."""
    lamp = glass.LAMP
    forward = glass.unit(glass.sub(lamp["to"], lamp["from"]))
    side = glass.scaled(glass.unit(glass.cross(forward, (0, 1, 0))), lamp["size"])
    up = glass.scaled(glass.unit(glass.cross(side, forward)), lamp["size"])
    distance = math.dist(lamp["from"], lamp["to"])
    colour = lamp["radiance"] * lamp["size"] ** 2 / distance ** 2 / math.pi
    return (f"light_source {{ <{point(lamp['from'])}> rgb {colour:.6g} area_light <{point(side)}>, <{point(up)}>, 9, 9 "
            f"adaptive 2 jitter fade_distance {distance:.6g} fade_power 2 photons {{ reflection on refraction on }} }}\n")


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    text = HEAD.format(sky=glass.listed(glass.SKY), camera=point(glass.CAMERA["from"]),
                       target=point(glass.CAMERA["to"]), fov=glass.CAMERA["fov"]) + lamp_text()
    for _, medium, mesh in glass.hulls():
        ior, absorption = glass.MEDIA[medium]
        media = f"media {{ absorption <{glass.listed(absorption)}> }}" if any(absorption) else ""
        text += (mesh_text(mesh) + f"hollow texture {{ pigment {{ rgbt 1 }} finish {{ diffuse 0 ambient 0 emission 0 "
                 f"reflection {{ 0, 1 fresnel on }} conserve_energy }} }}\ninterior {{ ior {ior} {media} }}\n"
                 f"photons {{ target reflection on refraction on }} }}\n")
    text += (mesh_text(glass.table()) + f"texture {{ pigment {{ rgb <{glass.listed(glass.TABLE_ALBEDO)}> }} "
             f"finish {{ diffuse 1 ambient 0 emission 0 }} }} }}\n")
    with open(sys.argv[1], "w") as file:
        file.write(text)


main()
