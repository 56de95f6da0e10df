# polycnc with its kernel compiled for any processor of this kind: starts warm, runs as an ordinary user, writes nothing.
# docker build -t polycnc . && docker run --rm -v "$PWD:/work" polycnc run part.nc
FROM python:3.12-slim
ENV POLYCNC_CACHE_DIR=/opt/polycnc-cache NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES=
COPY . /src
RUN pip install --no-cache-dir '/src[cluster,parquet,plot,serve]' && rm -rf /src
RUN polycnc warmup run && chmod -R a+rX /opt/polycnc-cache
USER 65534:65534
WORKDIR /work
ENTRYPOINT ["polycnc"]
