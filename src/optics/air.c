/* air.c - see air.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/air.h"

#include <math.h>

static const double rayleigh_height = 8.4, aerosol_height = 1.2, ozone_middle = 25, ozone_reach = 15;
static const double refractivity = 277e-6; /* at the ground, 15 degrees Celsius, 550 nm */

double air_band_nm(int band)
{
    return (double)SPECTRUM_MIN_NM + band * ((double)SPECTRUM_MAX_NM - (double)SPECTRUM_MIN_NM) / (AIR_BANDS - 1);
}

/* Cross section of ozone in 1e-21 cm^2, rounded, after V. Gorshelev et al., "High spectral resolution ozone absorption
 * cross-sections", Atmospheric Measurement Techniques 7 (2014): every 20 nm from 400 nm. */
static double ozone_cross_section(double um)
{
    static const double values[] = {0.01, 0.03, 0.12, 0.35, 0.7,  1.2, 1.8,  2.9, 3.9, 4.7,  5.1,
                                    4.0,  2.9,  2.1,  1.4,  0.88, 0.6, 0.42, 0.3, 0.2, 0.12, 0.1};
    double at = (1e3 * um - 400) / 20;
    if (at < 0) return values[0];
    int i = (int)at;
    if (i >= (int)(sizeof values / sizeof *values) - 1) return values[sizeof values / sizeof *values - 1];
    return values[i] + (at - i) * (values[i + 1] - values[i]);
}

static double rayleigh_depth(double um)
{
    double w = 1 / (um * um);
    return 0.008569 * w * w * (1 + 0.0113 * w + 0.00013 * w * w);
}

/* Extinction per km where each substance is densest, at any wavelength. */
static void extinctions(double turbidity, double um, double *rayleigh, double *aerosol, double *ozone)
{
    const double molecules = 8.07e18; /* per cm^2, 300 Dobson units */
    *rayleigh = rayleigh_depth(um) / rayleigh_height;
    *aerosol = (turbidity - 1) * rayleigh_depth(0.55) * pow(um / 0.55, -1.3) / aerosol_height;
    *ozone =
        molecules * 1e-21 * ozone_cross_section(um) / ozone_reach; /* the layer is a triangle: its area is the reach */
}

Columns air_density(double height)
{
    double ozone = 1 - fabs(height - ozone_middle) / ozone_reach;
    return (Columns){expf((float)(-height / rayleigh_height)), expf((float)(-height / aerosol_height)),
                     (float)fmax(ozone, 0)};
}

bool air_line(double radius, double cosine, double *length)
{
    double miss = radius * radius * (1 - cosine * cosine);
    bool ground = cosine < 0 && miss < air_ground * air_ground;
    *length = ground ? fmax(-radius * cosine - sqrt(air_ground * air_ground - miss), 0)
                     : -radius * cosine + sqrt(fmax(air_top * air_top - miss, 0));
    return ground;
}

/* ---- up to space ---- */

typedef struct ColumnSum {
    double rayleigh, aerosol, ozone;
} ColumnSum;

static void add_column(ColumnSum *sum, double height, double step)
{
    Columns density = air_density(height);
    sum->rayleigh += step * (double)density.rayleigh;
    sum->aerosol += step * (double)density.aerosol;
    sum->ozone += step * (double)density.ozone;
}

static Columns columns_up(double radius, double cosine)
{
    enum { FINE = 160 };
    double length;
    ColumnSum sum = {0};
    (void)air_line(radius, fmax(cosine, 0), &length);
    double lowest = cosine < 0 ? -radius * cosine : 0; /* along the line; as far behind it as it is away */
    if (cosine < 0) (void)air_line(radius * sqrt(1 - cosine * cosine), 0, &length);
    double least = cosine < 0 ? radius * sqrt(1 - cosine * cosine) : radius, up = fmax(cosine, 0);
    for (int part = 0; part < 2; part++) { /* beyond the lowest place, and before it */
        double reach = part ? lowest : length;
        for (int i = 0; i < FINE && reach > 0; i++) { /* steps grow with the square */
            double u = (i + 0.5) / FINE, at = reach * u * u;
            add_column(&sum, sqrt(least * least + at * at + 2 * least * at * up) - air_ground, reach * 2 * u / FINE);
        }
    }
    return (Columns){(float)sum.rayleigh, (float)sum.aerosol, (float)sum.ozone};
}

static double horizon_cosine(double radius)
{
    double ratio = air_ground / radius;
    return ratio < 1 ? -sqrt(1 - ratio * ratio) : 0;
}

void air_init(Air *air, double turbidity)
{
    for (int k = 0; k < AIR_BANDS; k++) {
        double rayleigh, aerosol, ozone;
        extinctions(turbidity, 1e-3 * air_band_nm(k), &rayleigh, &aerosol, &ozone);
        air->rayleigh[k] = (float)rayleigh;
        air->aerosol[k] = (float)aerosol;
        air->ozone[k] = (float)ozone;
    }
    for (int h = 0; h < AIR_COLUMN_HEIGHTS; h++)
        for (int a = 0; a < AIR_COLUMN_ANGLES; a++) {
            double up = (double)h / (AIR_COLUMN_HEIGHTS - 1), radius = air_ground + up * up * (air_top - air_ground);
            double horizon = horizon_cosine(radius), part = (double)a / (AIR_COLUMN_ANGLES - 1);
            air->columns[h][a] = columns_up(radius, horizon + part * part * (1 - horizon));
        }
}

static Columns mix_columns(const Columns *a, const Columns *b, float t)
{
    return (Columns){a->rayleigh + t * (b->rayleigh - a->rayleigh), a->aerosol + t * (b->aerosol - a->aerosol),
                     a->ozone + t * (b->ozone - a->ozone)};
}

bool air_columns(const Air *air, double radius, double cosine, Columns *columns)
{
    double horizon = horizon_cosine(radius);
    if (cosine < horizon) return false;
    double y = sqrt(fmin(fmax((radius - air_ground) / (air_top - air_ground), 0), 1)) * (AIR_COLUMN_HEIGHTS - 1);
    double x = sqrt((cosine - horizon) / (1 - horizon)) * (AIR_COLUMN_ANGLES - 1);
    int row = y < AIR_COLUMN_HEIGHTS - 2 ? (int)y : AIR_COLUMN_HEIGHTS - 2,
        column = x < AIR_COLUMN_ANGLES - 2 ? (int)x : AIR_COLUMN_ANGLES - 2;
    const Columns *below = &air->columns[row][column], *above = &air->columns[row + 1][column];
    Columns low = mix_columns(below, below + 1, (float)(x - column)),
            high = mix_columns(above, above + 1, (float)(x - column));
    *columns = mix_columns(&low, &high, (float)(y - row));
    return true;
}

/* n r cos(elevation) stays the same along a bent ray, so that its length grows by n r / sqrt((n r)^2 - that^2) for each
 * kilometre of height; the steps of the root of the height take the pole away. */
double air_sun_transmittance(double turbidity, double elevation_rad, double nm)
{
    enum { FINE = 600 };
    double kept = (1 + refractivity) * air_ground * cos(elevation_rad), root = sqrt(air_top - air_ground);
    ColumnSum sum = {0};
    for (int i = 0; i < FINE; i++) {
        double t = (i + 0.5) / FINE * root, height = t * t;
        double bent = (1 + refractivity * exp(-height / rayleigh_height)) * (air_ground + height);
        add_column(&sum, height, 2 * t * root / FINE * bent / sqrt(fmax(bent * bent - kept * kept, 1e-9)));
    }
    double rayleigh, aerosol, ozone;
    extinctions(turbidity, 1e-3 * nm, &rayleigh, &aerosol, &ozone);
    return exp(-(rayleigh * sum.rayleigh + aerosol * sum.aerosol + ozone * sum.ozone));
}
