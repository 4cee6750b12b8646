# syntax=docker/dockerfile:1
# One image for API, worker and migration; docker-compose.yml says which command each of them runs.
# The bases have full versions; a digest differs with the registry: --build-arg PYTHON_IMAGE=python@sha256:... pins yours.
ARG PYTHON_IMAGE=python:3.11.14-slim-bookworm
ARG UV_IMAGE=ghcr.io/astral-sh/uv:0.13.9
ARG NODE_IMAGE=node:24.19.0-bookworm-slim

FROM ${UV_IMAGE} AS uv

FROM ${NODE_IMAGE} AS page
WORKDIR /src/web
COPY web/package.json web/package-lock.json web/.npmrc ./
RUN npm ci --no-audit --no-fund
COPY web ./
RUN npm run build

# the dependencies change less often than the code and get a stage of their own
FROM ${PYTHON_IMAGE} AS dependencies
COPY --from=uv /uv /usr/local/bin/uv
ENV UV_COMPILE_BYTECODE=1 \
    UV_CACHE_DIR=/uv-cache \
    UV_LINK_MODE=copy \
    UV_PROJECT_ENVIRONMENT=/opt/integument \
    UV_PYTHON_DOWNLOADS=never
WORKDIR /src
COPY pyproject.toml uv.lock ./
COPY client/pyproject.toml client/
RUN --mount=type=cache,target=/uv-cache \
    uv sync --frozen --no-default-groups --extra telemetry --no-install-workspace

FROM dependencies AS handbook
RUN --mount=type=cache,target=/uv-cache \
    uv sync --frozen --no-default-groups --group docs --no-install-workspace
COPY CHANGELOG.md CONTRIBUTING.md LICENSE README.md SECURITY.md ./
COPY client/README.md client/
COPY core core
COPY docs docs
COPY openapi openapi
COPY scripts scripts
RUN /opt/integument/bin/python scripts/docs.py

FROM dependencies AS build
COPY LICENSE README.md ./
COPY client client
COPY api api
COPY core core
COPY sandbox sandbox
COPY server server
COPY store store
COPY worker worker
COPY --from=page /src/api/static api/static
COPY --from=page /src/core/reports/viewer core/reports/viewer
COPY --from=handbook /src/api/handbook api/handbook
# a cache that outlives this build knows our own wheels by pyproject.toml alone and would bring those of older sources
RUN uv sync --no-cache --frozen --no-default-groups --extra telemetry --no-editable

FROM ${PYTHON_IMAGE}
LABEL org.opencontainers.image.title="Integument" \
      org.opencontainers.image.licenses="AGPL-3.0-or-later"
# What gmsh, one of the two meshers, is linked with. Debian keeps one version of each per release, so a pin would only break the build:
# hadolint ignore=DL3008
RUN apt-get update --quiet \
    && apt-get install --yes --quiet --no-install-recommends \
        libfontconfig1 libgl1 libglu1-mesa libgomp1 libxcursor1 libxfixes3 libxft2 libxinerama1 \
    && rm -rf /var/lib/apt/lists/*
RUN install --directory --owner=10001 --group=10001 --mode=0700 /data
COPY --from=build /opt/integument /opt/integument
# the root file system is read-only: compiled kernels are kept with the data, everything passing goes to /tmp
ENV PATH=/opt/integument/bin:$PATH \
    HOME=/tmp \
    INTEGUMENT_DATA_DIR=/data \
    MPLCONFIGDIR=/tmp/matplotlib \
    NUMBA_CACHE_DIR=/data/numba-cache \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1
WORKDIR /data
USER 10001:10001
VOLUME /data
EXPOSE 8000
CMD ["python", "-m", "api"]
